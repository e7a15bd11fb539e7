#include "core/sphere/insertion.h"

#include <algorithm>
#include <cmath>

#include "core/sphere/sphere_math.h"

namespace orbis::sphere {
namespace {

// Rounding of the triple product, relative to the lengths of its factors: what is below cannot be trusted.
constexpr double relative_error = 1e-15;
constexpr int most_halvings = 48;

bool sees_all(const Vec3d& p, std::span<const Vec3d> polygon) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d u = polygon[k] - p, v = polygon[(k + 1) % polygon.size()] - p;
    const double V = dot(p, cross(u, v));
    if (!(V > 0) || V * V <= relative_error * relative_error * squared_norm(u) * squared_norm(v)) return false;
  }
  return true;
}

// The direction that halves the wedge at polygon[0] between its two neighbours, in the tangent plane.
Vec3d wedge_bisector(std::span<const Vec3d> polygon) {
  const Vec3d& p = polygon[0];
  const auto tangent = [&](const Vec3d& q) {
    const Vec3d d = q - p;
    return normalized(d - dot(d, p) * p);
  };
  const Vec3d right = tangent(polygon[1]), left = tangent(polygon.back());
  const Vec3d middle = right + left;
  // The wedge runs counter-clockwise from right to left. Where it is reflex the sum points out of it; where it is
  // nearly straight the sum vanishes and the normal of `right` is exact enough.
  const double turn = dot(p, cross(right, left));
  if (squared_norm(middle) < 1e-6) return cross(p, right);
  return normalized(turn >= 0 ? middle : -middle);
}

} // namespace

std::optional<Vec3d> point_in_kernel(std::span<const Vec3d> polygon) {
  Vec3d sum{};
  double nearest = 4;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    sum += polygon[k];
    if (k > 0) nearest = std::min(nearest, squared_norm(polygon[k] - polygon[0]));
  }
  const Vec3d& parent = polygon[0];
  if (squared_norm(sum) > 1e-6) {
    const Vec3d middle = normalized(sum);
    Vec3d way = middle - parent;
    for (int i = 0; i < 4; ++i, way *= 0.5) {
      const Vec3d p = normalized(parent + way);
      if (sees_all(p, polygon)) return p;
    }
  }
  const Vec3d direction = wedge_bisector(polygon);
  double step = 0.5 * std::sqrt(nearest);
  for (int i = 0; i < most_halvings; ++i, step *= 0.5) {
    const Vec3d p = normalized(parent + step * direction);
    if (sees_all(p, polygon)) return p;
  }
  return std::nullopt;
}

} // namespace orbis::sphere
