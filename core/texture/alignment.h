// The rotation that brings one set of points closest to another.
#pragma once

#include <array>
#include <span>

#include "core/vec3.h"

namespace orbis::texture {

struct Rotation {
  std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

  [[nodiscard]] Vec3d operator()(const Vec3d& p) const { return {dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)}; }
  [[nodiscard]] Vec3d inverse(const Vec3d& p) const { return rows[0] * p.x + rows[1] * p.y + rows[2] * p.z; }
};

// The rotation R that makes sum w_i |R from_i - to_i|^2 smallest (Horn, Closed-form solution of absolute orientation
// using unit quaternions, 1987). All spans of one size.
[[nodiscard]] Rotation best_rotation(std::span<const Vec3d> from, std::span<const Vec3d> to,
                                     std::span<const double> weights);

} // namespace orbis::texture
