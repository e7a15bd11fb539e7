#include "core/sphere/shape_preserving_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace orbis::sphere {

Vec3d insertion_place(const Star& star, std::size_t parent, std::size_t left, std::size_t right, double floor) {
  const Vec3d v = star.ring[parent];
  const TangentBasis basis = tangent_basis(v);
  const auto direction = [&](const Vec3d& q) { return std::atan2(dot(q - v, basis.e2), dot(q - v, basis.e1)); };
  // Seen from the parent, the new vertex's sector goes counter-clockwise from left to right.
  const double from = direction(star.ring[left]);
  double opening = direction(star.ring[right]) - from;
  if (opening <= 0) opening += 2 * std::numbers::pi;
  const double middle = from + 0.5 * opening;
  const Vec3d towards = basis.e1 * std::cos(middle) + basis.e2 * std::sin(middle);

  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < star.ring.size(); ++k)
    if (k != parent) nearest = std::min(nearest, norm(star.ring[k] - v));

  Vec3d best = v;
  double least = std::numeric_limits<double>::infinity();
  double distance = nearest;
  while ((distance *= 0.5) > 1e-16) {
    const Vec3d candidate = normalized(v + towards * distance);
    const double energy = star_energy(star, candidate, floor);
    if (energy < least) {
      least = energy;
      best = candidate;
    } else if (std::isfinite(least)) {
      break; // worse than the one before: closer is not better any more
    }
  }
  return best;
}

std::array<Vec3d, 4> regular_tetrahedron() {
  const double s = 1 / std::numbers::sqrt3;
  return {Vec3d(s, s, s), Vec3d(s, -s, -s), Vec3d(-s, s, -s), Vec3d(-s, -s, s)};
}

Vec3d moebius(const Vec3d& x, const Vec3d& a) {
  const Vec3d d = x - a;
  return normalized(d * ((1 - squared_norm(a)) / squared_norm(d)) - a);
}

bool survives_rounding(std::span<const mesh::Triangle> triangles, std::span<const Vec3d> points) {
  return std::all_of(triangles.begin(), triangles.end(), [&](const mesh::Triangle& t) {
    const Vec3d &p = points[t[0]], &q = points[t[1]], &r = points[t[2]];
    const double longest2 = std::max({squared_norm(q - p), squared_norm(r - q), squared_norm(p - r)});
    return orientation_volume(p, q, r) > 0x1p-22 * std::sqrt(longest2);
  });
}

} // namespace orbis::sphere
