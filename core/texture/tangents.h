// Tangent frames by the MikkTSpace conventions (M. S. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008),
// which glTF 2.0 names as the default.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::texture {

// glTF's TANGENT: a unit vector along growing u, and w = +1 or -1 so that the bitangent, towards the image's top, is
// w cross(normal, tangent).
struct Tangent {
  float x = 1, y = 0, z = 0, w = 1;
  friend constexpr bool operator==(const Tangent&, const Tangent&) = default;
};

// One tangent a corner of each triangle.
//
// positions, normals (unit), uv (v down, as in glTF): one per vertex; vertices that agree in all three to the bit are
// one. A corner's tangent is the mean, weighted by the triangles' angles there, of the u directions of the triangles
// around the vertex that are reached across edges and have its handedness, each brought into the tangent plane of
// the normal. Triangles without area in the texture take their neighbours' tangent; where nothing says what it is, it
// is any vector perpendicular to the normal. O(triangles).
[[nodiscard]] std::vector<std::array<Tangent, 3>> corner_tangents(std::span<const Vec3f> positions,
                                                                  std::span<const Vec3f> normals,
                                                                  std::span<const Vec2f> uv,
                                                                  std::span<const mesh::Triangle> triangles);

} // namespace orbis::texture
