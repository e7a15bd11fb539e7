// Exact orientation in the atlas.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace orbis::lod {

// Sign of the area of (a, b, c), whose coordinates are 0 or between 2^-28 and 2 in magnitude: +1, 0 or -1, exact.
//
// Differences of such floats are exact in double. The difference of the two products is computed after Kahan with the
// products' rounding errors, which fma gives exactly; its relative error is below 2 ulp (Jeannerod, Louvet, Muller,
// Further analysis of Kahan's algorithm, 2013), so its sign is right.
[[nodiscard]] inline int uv_orientation(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  const double ux = double{b.x} - a.x, uy = double{b.y} - a.y, vx = double{c.x} - a.x, vy = double{c.y} - a.y;
  const double right = uy * vx;
  const double rest = std::fma(-uy, vx, right);
  const double area = std::fma(ux, vy, -right) + rest;
  return (area > 0) - (area < 0);
}

} // namespace orbis::lod
