// The six faces of the cube around the sphere, in OpenGL's order and orientation.
//
// A face image is what a viewer outside the sphere sees who looks at the face with +Y up (for +Y: -Z up, for -Y: +Z
// up): u to the right, v down, first row on top. OpenGL, Vulkan and WebGL define cube maps in a left-handed system, so
// this is exactly their table (s, t of the major axis), and images named px, nx, py, ny, pz, nz fit without a flip.
//
// Points go to a face by plain central (gnomonic) projection. Great circles become straight lines there, so a triangle
// that is positively oriented on the sphere is a triangle of the same orientation in the face, whatever its size: the
// charts cannot overlap. The tangent (equi-angular) warp has more even texels (area ratio 1.4 in place of 5.2 between
// the centre and a corner), but bends edges, and thin triangles then fold in the atlas.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/sphere/orientation.h"
#include "core/vec3.h"

namespace orbis::texture {

// A face, and equally the signed axis through its centre: 0..5 = +X -X +Y -Y +Z -Z.
using Face = std::uint8_t;
inline constexpr std::size_t face_count = 6;

inline constexpr std::array<Face, face_count> face_right{5, 4, 0, 0, 0, 1}; // the axis along which u grows
inline constexpr std::array<Face, face_count> face_down{3, 3, 4, 5, 3, 3};  // the axis along which v grows

constexpr Face opposite(Face f) { return f ^ 1U; }
constexpr std::size_t axis_of(Face f) { return f >> 1U; }

// The faces around f, counter-clockwise as seen from outside: right, up, left, down.
constexpr std::array<Face, 4> neighbours_of(Face f) {
  return {face_right[f], opposite(face_down[f]), opposite(face_right[f]), face_down[f]};
}

// The coordinate of p along a signed axis.
constexpr std::int32_t along(const sphere::GridPoint& p, Face f) {
  const std::int32_t value = p[axis_of(f)];
  return (f & 1U) != 0 ? -value : value;
}
constexpr double along(const Vec3d& p, Face f) {
  const double value = axis_of(f) == 0 ? p.x : axis_of(f) == 1 ? p.y : p.z;
  return (f & 1U) != 0 ? -value : value;
}
constexpr Vec3d axis_vector(Face f) {
  const double sign = (f & 1U) != 0 ? -1 : 1;
  return {axis_of(f) == 0 ? sign : 0, axis_of(f) == 1 ? sign : 0, axis_of(f) == 2 ? sign : 0};
}

// The face that a direction (not zero) points at; on a border the one with the lower number.
constexpr Face face_of(const Vec3d& d) {
  const auto magnitude = [](double v) { return v < 0 ? -v : v; };
  const double x = magnitude(d.x), y = magnitude(d.y), z = magnitude(d.z);
  if (x >= y && x >= z) return d.x < 0 ? 1 : 0;
  if (y >= z) return d.y < 0 ? 3 : 2;
  return d.z < 0 ? 5 : 4;
}

// Face coordinates, [-1, 1] inside the face, u right and v down.
struct FacePoint {
  double u = 0, v = 0;
};
// The central projection of p to the plane of face f. p must be in front of it: along(p, f) > 0.
template <class Point> constexpr FacePoint project(const Point& p, Face f) {
  const double depth = along(p, f);
  return {along(p, face_right[f]) / depth, along(p, face_down[f]) / depth};
}
// Its inverse: a direction, not normalized.
constexpr Vec3d direction(Face f, const FacePoint& p) {
  return axis_vector(f) + axis_vector(face_right[f]) * p.u + axis_vector(face_down[f]) * p.v;
}

} // namespace orbis::texture
