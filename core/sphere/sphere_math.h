// Triangles on the unit sphere, in forms that keep their digits when the three points are close together.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace orbis::sphere {

// det(p, a, b): positive where (p, a, b) is counter-clockwise seen from outside, twice the chordal area to first order.
// From differences: the determinant of three nearly equal vectors loses twice as many digits.
inline double triple_product(const Vec3d& p, const Vec3d& a, const Vec3d& b) { return dot(p, cross(a - p, b - p)); }

// Signed solid angle of the spherical triangle (a, b, c) in steradians, in (-2 pi, 2 pi).
// Van Oosterom and Strackee (1983), Eq. 8, for vectors of unit length.
inline double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(triple_product(a, b, c), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

} // namespace orbis::sphere
