// What a job found, did and proved: the facts behind GET /v1/jobs/{id}/report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/topology.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"
#include "core/texture/atlas_certificate.h"
#include "core/texture/quality.h"
#include "core/vec3.h"

namespace orbis {

struct StageTime {
  Stage stage = Stage::decode;
  double wall_ms = 0, cpu_ms = 0;
};

// A fact worth telling: a repair, a property that could not be kept, a bound that was reached.
struct Note {
  std::string code, message, where;
};

// What was done to the surface before it could be unfolded, all components together.
struct Repairs {
  std::uint64_t degenerate_triangles = 0; // two corners at one position: delivered, but no part of the surface
  std::uint64_t duplicate_triangles = 0;  // lie on another one of the same material: delivered with its coordinates
  std::uint64_t turned_triangles = 0;     // turned to agree with their neighbours
  std::uint64_t shared_edges = 0;         // of three triangles or more, cut apart
  std::uint64_t double_edges = 0;         // joined the same two vertices as another edge, cut apart
  std::uint64_t split_vertices = 0;       // added where sheets were cut apart
  std::uint64_t one_sided_edges = 0;      // cut, since the surface had only one side
  std::uint64_t crack_triangles = 0;      // put into cracks at T-junctions, for the parametrization only
  std::uint64_t internal_triangles = 0;   // of walls inside a body; parametrized like the rest
  std::uint64_t capped_loops = 0;         // boundary loops closed for the parametrization only, those of cuts included
  std::uint64_t handles = 0, handle_cut_edges = 0;
  double handle_cut_length = 0; // in the model's units
};

// One component of the surface: what it was, what was done to it, and what came out.
struct ComponentReport {
  std::uint32_t mesh = 0; // of the document
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t genus = 0, boundary_loops = 0, boundary_edges = 0; // as found
  std::uint64_t turned_triangles = 0, crack_triangles = 0, cap_triangles = 0;
  std::uint64_t handles = 0, handle_cut_edges = 0;
  double handle_cut_length = 0;
  std::uint64_t remesh_triangles = 0, remesh_vertices = 0; // what took its place; 0: it was not remeshed
  sphere::Distortion distortion; // of the delivered triangles, scaled to their part of the sphere
  bool certified = false;
  std::optional<Note> problem; // why it has no parametrization; its triangles are delivered as they came
};

struct Report {
  std::string format; // "glb", "gltf", "draco", "obj", "ply" or "stl"
  Options options;
  std::uint64_t input_triangles = 0, input_vertices = 0;
  mesh::Topology topology;
  Repairs repairs;
  std::vector<ComponentReport> components;
  bool partial = false;                   // a component has a problem
  double t1_ms = 0, t2_ms = 0, t3_ms = 0; // the paper's steps
  double minimum = 0;                     // the paper's Eq. 3
  std::uint64_t relaxations = 0;
  bool converged = true;
  sphere::Distortion distortion;
  struct Atlas {
    struct Page {
      std::uint32_t width = 0, height = 0; // texels
    };
    std::vector<Page> pages;
    std::uint32_t gutter = 0;
    std::uint64_t charts = 0, cut_triangles = 0, added_vertices = 0;
    double utilisation = 0; // texels covered by triangles / all texels
    texture::AtlasQuality quality;
    std::string source; // "pattern", "cubemap", "base_color", "none"
  } atlas;
  // A level of detail, as measured on its delivered triangles. Lengths are in per cent of the model's diagonal.
  struct Level {
    std::string target; // as the option says it
    std::uint64_t triangles = 0, vertices = 0;
    double mean_distance = 0, mean_distance_from_full = 0; // of its points from the full surface, and the other way
    double hausdorff_distance = 0;
    double texture_deviation = 0, texture_deviation_max = 0; // from the full surface's point of the same texel
    double outside = 0;                                      // per cent of its surface that samples outside the charts
    double psnr = 0;            // dB: a render as delivered, through its normal map, against the full surface's
    double screen_coverage = 0; // where the model fills less of the screen's height, it may stand for the level before
    std::uint64_t folded = 0;   // triangles that are not positively oriented, on the sphere or in the atlas
    double degree = 0;          // of the map to the sphere, that of the worst component
    // What gave way for the target.
    bool turned_normals = false, reached = true;
    double outline_texels = 0; // how far a seam between materials has left its line in the atlas
    std::uint64_t torn_edges = 0, opened_points = 0, lost_components = 0;
    double lost_size = 0; // the diagonal of the largest component that was left out
  };
  std::vector<Level> levels;
  // What options.remesh did. Lengths are in per cent of the diagonal of the components that were remeshed.
  struct Remesh {
    std::uint64_t components = 0, kept_components = 0;      // kept: not remeshed, a note says why
    std::uint64_t triangles = 0, vertices = 0;              // of those that were, before the atlas' cuts
    double mean_distance = 0, mean_distance_from_input = 0; // of its points from the input, and the other way
    double hausdorff_distance = 0;
  };
  std::optional<Remesh> remesh;
  // What options.morph_to did; remesh says how far the first model's end is from it.
  struct Morph {
    std::string format; // of the second model
    std::uint64_t input_triangles = 0;
    // Of the second model's end from it, in per cent of its diagonal, as for a remesh.
    double mean_distance = 0, mean_distance_from_input = 0, hausdorff_distance = 0;
    std::uint64_t features = 0; // pairs of points
    // Between the features' points on the two spheres, in degrees: as the models lie, and as they were brought
    // together.
    double mean_angle_before = 0, mean_angle = 0, largest_angle = 0;
  };
  std::optional<Morph> morph;
  // The images that were baked, all of the texture coordinates that the result calls the atlas'.
  struct BakedMap {
    std::string name; // of the file: "normal.png"; with several pages "normal-2.png"
    std::uint32_t page = 0, width = 0, height = 0, bits = 8;
    std::uint64_t bytes = 0;
    // Position maps: a texel's number n in [0, 1] is the coordinate offset + n * scale. Displacement maps: so is the
    // distance along the level's normal, by x alone.
    struct Range {
      Vec3d offset, scale;
    };
    std::optional<Range> range;
  };
  std::vector<BakedMap> maps;
  std::uint64_t output_triangles = 0, output_vertices = 0;
  sphere::Certificate certificate;     // of the surface at the input's connectivity, as delivered
  sphere::Certificate cut_certificate; // of the delivered triangles, cut at the atlas' borders
  texture::AtlasCertificate atlas_certificate;
  std::vector<StageTime> stages;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<Note> notes;
};

} // namespace orbis
