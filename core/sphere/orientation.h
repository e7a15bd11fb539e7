// Exact orientation on the sphere: the sign of det(a, b, c), decided without any epsilon.
#pragma once

#include <array>
#include <cstdint>

#include "core/vec3.h"

namespace orbis::sphere {

// Delivered points have coordinates that are multiples of 2^-24: exact in float32, and integers of 25 bits after
// scaling.
inline constexpr int grid_bits = 24;
using GridPoint = std::array<std::int32_t, 3>; // coordinate * 2^24

// The nearest grid point of a unit vector, and back (exact in both float and double).
[[nodiscard]] GridPoint to_grid(const Vec3d& p);
[[nodiscard]] Vec3f from_grid(const GridPoint& g);
// The grid point of a delivered vector. Returns false if a coordinate is not a multiple of 2^-24 or exceeds 1 in
// magnitude.
[[nodiscard]] bool grid_point_of(const Vec3f& p, GridPoint& out);

// Sign of det(a, b, c): +1 where the triangle is counter-clockwise seen from outside the sphere, 0 where the three
// points and the centre lie in one plane, -1 where it is folded over. Exact: the determinant fits 128 bits.
[[nodiscard]] int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c);

} // namespace orbis::sphere
