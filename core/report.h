// What a job found, did and proved: the facts behind GET /v1/jobs/{id}/report.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/topology.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"

namespace orbis {

struct StageTime {
  Stage stage = Stage::decode;
  double wall_ms = 0, cpu_ms = 0;
};

// A fact worth telling: a repair, a property that could not be kept, a bound that was reached.
struct Note {
  std::string code, message, where;
};

struct Report {
  std::string format; // "glb", "gltf", "draco"
  Options options;
  std::uint64_t input_triangles = 0, input_vertices = 0;
  mesh::Topology topology;
  std::uint64_t degenerate_triangles = 0; // left out of the surface: two corners at one position
  std::uint64_t turned_triangles = 0;     // turned to agree with their neighbours
  double t1_ms = 0, t2_ms = 0, t3_ms = 0; // the paper's steps
  double minimum = 0;                     // the paper's Eq. 3
  std::uint64_t relaxations = 0;
  bool converged = true;
  sphere::Distortion distortion;
  struct Atlas {
    std::uint32_t width = 0, height = 0, gutter = 0;
    std::uint64_t charts = 0, cut_triangles = 0, added_vertices = 0;
    double utilisation = 0; // texels covered by charts / all texels
    std::string source;     // "pattern", "cubemap", "base_color"
  } atlas;
  // A level of detail, as measured on its delivered triangles. Lengths are in per cent of the model's diagonal.
  struct Level {
    std::string target; // as the option says it
    std::uint64_t triangles = 0, vertices = 0;
    double mean_distance = 0, mean_distance_from_full = 0; // of its points from the full surface, and the other way
    double hausdorff_distance = 0;
    double texture_deviation = 0, texture_deviation_max = 0; // from the full surface's point of the same texel
    double outside = 0;                                      // per cent of its surface that samples outside the charts
    double screen_coverage = 0; // where the model fills less of the screen's height, it may stand for the level before
    std::uint64_t folded = 0;   // triangles that are not positively oriented, on the sphere or in the atlas
    double degree = 0;          // of the map to the sphere, that of the worst component
    // What gave way for the target.
    bool turned_normals = false, reached = true;
    double outline_texels = 0;
    std::uint64_t lost_components = 0;
  };
  std::vector<Level> levels;
  std::uint64_t output_triangles = 0, output_vertices = 0;
  sphere::Certificate certificate;     // of the surface at the input's connectivity, as delivered
  sphere::Certificate cut_certificate; // of the delivered triangles, cut at the atlas' borders
  std::vector<StageTime> stages;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<Note> notes;
};

} // namespace orbis
