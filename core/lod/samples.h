// Points spread evenly over a surface, always the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::lod {

struct Sample {
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{};

  [[nodiscard]] Vec3d on(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles) const {
    const mesh::Triangle& t = triangles[triangle];
    return positions[t[0]] * weights[0] + positions[t[1]] * weights[1] + positions[t[2]] * weights[2];
  }
};

// `count` points, one for each equal share of the area in the order of the triangles; inside their triangles they
// follow Roberts' R2 sequence, folded to the triangle. Nothing where the surface has no area.
[[nodiscard]] std::vector<Sample> spread_samples(std::span<const Vec3d> positions,
                                                 std::span<const mesh::Triangle> triangles, std::size_t count);

} // namespace orbis::lod
