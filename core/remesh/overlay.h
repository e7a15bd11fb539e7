// Two triangulations of one sphere laid over each other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/texture/atlas.h"
#include "core/vec3.h"

namespace orbis::remesh {

// A corner of the part that a triangle of each has in common: the same point of the sphere, up to length
// sum on_source_i s_i = sum on_target_i t_i. Both sets of weights have the sum 1.
struct OverlayCorner {
  std::array<double, 3> on_source{}, on_target{};
};

// The part of the sphere that the triangles (s_0, s_1, s_2) and (t_0, t_1, t_2) have in common, counter-clockwise, of
// up to six corners; none where they do not overlap. Unit vectors, both positively oriented, the target's within one
// hemisphere. Sutherland and Hodgman's clipping (1974): a point p of the source lies in the target's cone where the
// three numbers det(p, t_1, t_2), … are not negative, and those are linear in p.
[[nodiscard]] std::vector<OverlayCorner> common_part(const std::array<Vec3d, 3>& source,
                                                     const std::array<Vec3d, 3>& target);

// One component of a surface and of its remesh, on the same sphere.
struct OverlayPair {
  std::span<const Vec3d> source_points; // unit
  std::span<const mesh::Triangle> source_triangles;
  std::uint32_t first_source_triangle = 0;      // what source triangle 0 is called in the result
  std::uint32_t first_piece = 0, end_piece = 0; // the triangles of `target` that belong to it
};

// The source surface in the target's atlas: its triangles cut along the edges of the target's, with the texture
// coordinates that the target's triangles have there. Projection from the centre takes great circles to lines, so each
// part is a polygon with straight sides in the atlas, and together they tile the charts up to rounding. What is baked
// from the result into the target's texels is what the source shows at the same points of the sphere.
//   directions  unit, one per vertex of `target`: the sphere's points in the source's frame
// Each part has vertices of its own: the result is for baking, not for delivery. `parent` counts source triangles.
[[nodiscard]] texture::CutMesh overlay(const texture::CutMesh& target, std::span<const Vec3d> directions,
                                       std::span<const OverlayPair> pairs, mesh::ThreadPool& pool);

} // namespace orbis::remesh
