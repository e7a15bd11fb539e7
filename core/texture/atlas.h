// The atlas: where every point of the surface lies in a texture.
//
// The surface is cut into charts, charts are laid flat, flat charts are packed into pages. Nothing outside this folder
// and the pipeline's steps depends on how that is done: what bakes or draws goes through the delivered triangles and
// their texture coordinates, whatever shape the charts have.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"
#include "core/sphere/orientation.h"
#include "core/vec3.h"

namespace orbis::texture {

// A vertex of the cut mesh: where it lies on the input triangle that it was cut from.
struct CutVertex {
  std::uint32_t triangle;            // input triangle
  std::array<double, 3> barycentric; // on its three corners: 3-D point = sum b_i P_i, sphere point = sum b_i s_i,
                                     // normalized. Exactly one 1 for an original corner, exactly one 0 on an edge. On
                                     // an edge the weights are computed from the edge's canonical direction (lower
                                     // welded vertex first), so both sides agree to the bit.
  sphere::GridPoint sphere;          // bit-identical on both sides of a cut
  Vec2f uv;                          // in its page, [0, 1], v down as in glTF; multiples of 2^-24
  std::uint32_t point; // identity on the surface, equal for copies of one point in several charts: the welded vertex,
                       // or a number after them
};

// Positions, normals or the like at the surface's vertices, at a cut vertex: sum b_i values_i.
template <class Values>
[[nodiscard]] Vec3d interpolated(const Values& values, std::span<const mesh::Triangle> triangles, const CutVertex& v) {
  Vec3d sum;
  for (std::size_t k = 0; k < 3; ++k) sum += Vec3d(values[triangles[v.triangle][k]]) * v.barycentric[k];
  return sum;
}

// The weights of a cut vertex on the corners of a triangle that it lies on, be it that of a neighbour: a point on an
// edge or at a corner may be described from the other side.
//   triangles  input triangles; those at an edge or a corner share its vertices
[[nodiscard]] std::array<double, 3> weights_on(std::uint32_t triangle, std::span<const mesh::Triangle> triangles,
                                               const CutVertex& v);

// A chart fills a rectangle of whole texels: every texel in it belongs to exactly one point of the surface.
struct Chart {
  std::uint32_t component = 0;                       // of the surface
  std::uint32_t page = 0;                            // index into CutMesh::pages
  std::uint32_t x = 0, y = 0, width = 0, height = 0; // texels from the page's top left corner; gutter not included
};

// One image of the atlas.
struct Page {
  std::uint32_t width = 0, height = 0; // texels, multiples of 4
};

struct CutMesh {
  std::vector<CutVertex> vertices;       // one per (point, chart, input wedge): see cut()
  std::vector<mesh::Triangle> triangles; // indices into vertices, in the order of the input triangles
  std::vector<std::uint32_t> parent;     // cut triangle -> input triangle
  std::vector<std::uint32_t> chart;      // cut triangle -> chart
  std::vector<Chart> charts;
  std::vector<Page> pages;
  std::uint32_t gutter = 0;        // texels around each chart that no other chart's gutter reaches
  std::uint64_t cut_triangles = 0; // input triangles that were cut
  std::uint64_t points = 0;        // distinct points of the surface

  [[nodiscard]] std::uint32_t page_of(std::size_t triangle) const { return charts[chart[triangle]].page; }
};

// Texels covered by triangles / all texels, over all pages.
[[nodiscard]] double utilisation(const CutMesh& mesh);

// How charts are laid flat in the end (flatten.h): by Newton's method, where it pays, or by sweeps alone, which leave
// texels less even and fewer triangles so thin that rounding folds them.
enum class Finish : std::uint8_t { newton, sweeps };

// What an atlas is made for: one component of a surface, mapped to a sphere of its own.
struct AtlasComponent {
  std::span<const mesh::Triangle> triangles; // welded, certified: every triangle positively oriented on the sphere
  std::span<const mesh::Triangle> corners;   // of the delivered triangles: three input vertices (before welding) each
  std::span<const sphere::GridPoint> sphere; // one per welded vertex
  std::span<const Vec3f> positions;          // one per welded vertex
  std::size_t delivered = 0;                 // triangles from here on only close holes: they are not in the result
  std::uint32_t first_vertex = 0;            // what the component's vertex 0 and triangle 0 are called in the result
  std::uint32_t first_triangle = 0;
  std::uint32_t page = 0; // numbers from 0, without gaps over all components
  Finish finish = Finish::newton;
};

// The whole atlas of one component whose triangles are all delivered: cut, laid flat and packed (flat_charts.h,
// place.h).
//
// texture_size: as place() says. Throws Error{not_certified} where some triangle would not keep its orientation, on the
// sphere or in the atlas: turning the sphere a little then helps. Deterministic. Reports Stage::atlas, throws
// Error{canceled}.
[[nodiscard]] CutMesh make_atlas(const AtlasComponent& component, std::uint32_t texture_size, Progress& progress);

} // namespace orbis::texture
