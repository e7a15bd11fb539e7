// The cube-map atlas: six faces of a cube around the sphere, triangles cut exactly where they cross a face's border.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/orientation.h"
#include "core/vec3.h"

namespace orbis::texture {

// A vertex of the cut mesh: where it lies on the input triangle that it was cut from.
struct CutVertex {
  std::uint32_t triangle;            // input triangle
  std::array<double, 3> barycentric; // on its three corners; exactly one 1 for an original corner, exactly one 0 on an
                                     // edge. On an edge the weights are computed from the edge's canonical direction,
                                     // so both sides agree to the bit.
  sphere::GridPoint sphere; // bit-identical on both sides of a cut
  Vec2f uv;                 // in the atlas, [0, 1], v down as in glTF
  std::uint32_t point;      // identity on the surface: equal for copies of one point in several charts
};

struct AtlasLayout {
  std::uint32_t width = 0, height = 0; // texels
  std::uint32_t cell = 0;              // texels a face, gutter included (faces lie 3 by 2: +X -X +Y / -Y +Z -Z)
  std::uint32_t gutter = 0;            // texels around a face's charts
};

struct CutMesh {
  std::vector<CutVertex> vertices;       // one per (point, face, input wedge): see cut()
  std::vector<mesh::Triangle> triangles; // indices into vertices
  std::vector<std::uint32_t> parent;     // cut triangle -> input triangle
  std::vector<std::uint8_t> face;        // cut triangle -> cube face 0..5
  std::uint64_t cut_triangles = 0;       // input triangles that were cut
  std::uint64_t points = 0;              // distinct points of the surface
};

[[nodiscard]] AtlasLayout layout_for(std::uint32_t texture_size);

// Cuts. triangles: the welded surface, certified; corners: for each of its triangles the three input vertices (before
// welding), so that vertices are shared where the input shared them; sphere: one grid point per welded vertex.
// No T-junctions: a crossing on an edge is one point, shared by both triangles. All pieces are positively oriented on
// the sphere (exactly), else Error{not_certified}. A vertex within 2^-18 of a border counts as on it, so that pieces
// never degenerate; its uv may leave the face by that much, well inside the gutter.
[[nodiscard]] CutMesh cut(std::span<const mesh::Triangle> triangles, std::span<const mesh::Triangle> corners,
                          std::span<const sphere::GridPoint> sphere, const AtlasLayout& layout);

} // namespace orbis::texture
