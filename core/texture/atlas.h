// The cube-map atlas: six faces of a cube around the sphere, triangles cut exactly where they cross a face's border.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"
#include "core/sphere/orientation.h"
#include "core/texture/cube_map.h"
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
  Vec2f uv;                          // in the atlas, [0, 1], v down as in glTF
  std::uint32_t point; // identity on the surface, equal for copies of one point in several charts: the welded vertex,
                       // or a number after them
};

// Six square cells, 3 by 2: +X -X +Y / -Y +Z -Z. A cell is a chart (the face, [-1, 1] in both directions) with a
// gutter around it. In texels, from the top left corner; the texel (x, y) has its centre at (x + 0.5, y + 0.5).
struct AtlasLayout {
  std::uint32_t width = 0, height = 0;
  std::uint32_t cell = 0;   // a side of a cell, gutter included
  std::uint32_t gutter = 0; // on each side of a chart; a power of two

  [[nodiscard]] std::uint32_t chart() const { return cell - 2 * gutter; } // a side of a chart
  // The first texel of a chart.
  [[nodiscard]] std::uint32_t chart_x(Face f) const { return (f % 3U) * cell + gutter; }
  [[nodiscard]] std::uint32_t chart_y(Face f) const { return (f / 3U) * cell + gutter; }
  // The cell that a texel lies in; what is left over at the right and at the bottom counts to the last cell.
  [[nodiscard]] Face face_at(std::uint32_t x, std::uint32_t y) const;
  [[nodiscard]] bool in_chart(std::uint32_t x, std::uint32_t y) const;
  // Texels covered by charts / all texels.
  [[nodiscard]] double utilisation() const;

  // From face coordinates to texels and back; both go on linearly beyond the chart.
  [[nodiscard]] std::array<double, 2> texel_of(Face f, const FacePoint& p) const;
  [[nodiscard]] FacePoint face_point(Face f, double texel_x, double texel_y) const;
};

// texture_size: the width in texels, 64 to 8192, else Error{invalid_option}. The height is a multiple of 4. The gutter
// is the largest power of two up to cell / 40 (at least 2): 16 texels at 2048, so that bilinear reads stay within it
// on the first log2(gutter) - 1 mip levels.
[[nodiscard]] AtlasLayout layout_for(std::uint32_t texture_size);

struct CutMesh {
  std::vector<CutVertex> vertices;       // one per (point, face, input wedge): see cut()
  std::vector<mesh::Triangle> triangles; // indices into vertices, in the order of the input triangles
  std::vector<std::uint32_t> parent;     // cut triangle -> input triangle
  std::vector<Face> face;                // cut triangle -> cube face 0..5
  std::uint64_t cut_triangles = 0;       // input triangles that were cut
  std::uint64_t points = 0;              // distinct points of the surface
};

// Cuts the surface along the borders of the cube's faces.
//
//   triangles  the welded surface, certified: every triangle positively oriented on the sphere
//   corners    for each triangle its three input vertices (before welding); vertices of the result are shared where
//              point, face and input vertices agree
//   sphere     one grid point per welded vertex
//
// No T-junctions: a crossing on an edge is one point, shared by both triangles, exactly on the border's plane. All
// pieces are positively oriented on the sphere (exactly), else Error{not_certified}: turning the sphere a little
// against the cube then helps. A vertex within 2^-18 of a border counts as on it, so that pieces never degenerate; its
// uv may leave the face by that much, well inside the gutter. Deterministic; O(triangles). Reports Stage::atlas, throws
// Error{canceled}.
[[nodiscard]] CutMesh cut(std::span<const mesh::Triangle> triangles, std::span<const mesh::Triangle> corners,
                          std::span<const sphere::GridPoint> sphere, const AtlasLayout& layout, Progress& progress);

} // namespace orbis::texture
