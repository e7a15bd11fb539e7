#include "core/sphere/distortion_energy.h"

#include <algorithm>

namespace orbis::sphere {
namespace {

constexpr int most_halvings = 6;
constexpr double smallest_eigenvalue = 1e-3; // in units of the largest one

// The largest t in (0, 1] with all V of the star positive at p + t s, to first order, and a tenth of the way left.
double step_to_fold(std::span<const StarTerm> star, const Vec3d& p, const Vec3d& s) {
  double t = 1;
  for (const StarTerm& term : star) {
    const Vec3d u = term.a - p, v = term.b - p;
    const Vec3d uv = cross(u, v);
    const double V = dot(p, uv), slope = dot(cross(p, v - u) + uv, s);
    if (V + t * slope < 0.1 * V) t = std::min(t, -0.9 * V / slope);
  }
  return t;
}

} // namespace

Descent descent_step(const Expansion& e) {
  const double mean = 0.5 * (e.hxx + e.hyy), half = 0.5 * (e.hxx - e.hyy);
  const double radius = std::sqrt(half * half + e.hxy * e.hxy);
  if (mean - radius > smallest_eigenvalue * (mean + radius)) {
    const double det = e.hxx * e.hyy - e.hxy * e.hxy;
    return {-(e.hyy * e.gx - e.hxy * e.gy) / det, -(e.hxx * e.gy - e.hxy * e.gx) / det};
  }
  double large = std::abs(mean + radius), small = std::abs(mean - radius);
  const double floor = smallest_eigenvalue * std::max(large, small);
  large = std::max(large, floor);
  small = std::max(small, floor);
  // Eigenvector of mean + radius; any direction will do where the two are equal.
  double ex = e.hxy, ey = radius - half;
  if (half > 0) {
    ex = radius + half;
    ey = e.hxy;
  }
  const double length = std::sqrt(ex * ex + ey * ey);
  if (length > 0) {
    ex /= length;
    ey /= length;
  } else {
    ex = 1;
    ey = 0;
  }
  const double along = (e.gx * ex + e.gy * ey) / large, across = (e.gy * ex - e.gx * ey) / small;
  return {-(along * ex - across * ey), -(along * ey + across * ex)};
}

template <class Energy>
Vec3d newton_step(const Energy& energy, std::span<const StarTerm> star, const Vec3d& p, double& gain) {
  const TangentFrame frame(p);
  const Expansion e = expand(energy, star, p, frame);
  const Descent step = descent_step(e);
  gain = 0;
  const Vec3d s = step.x * frame.x + step.y * frame.y;
  double t = step_to_fold(star, p, s);
  if (!(t > 0)) return p;
  for (int i = 0; i < most_halvings; ++i, t *= 0.5) {
    const Vec3d q = normalized(p + t * s);
    const double now = star_energy(energy, star, q);
    if (now < e.energy) {
      gain = (e.energy - now) / e.energy;
      return q;
    }
  }
  return p;
}

template Vec3d newton_step(const SymmetricDirichlet&, std::span<const StarTerm>, const Vec3d&, double&);
template Vec3d newton_step(const Stretch&, std::span<const StarTerm>, const Vec3d&, double&);
template Vec3d newton_step(const AreaWeighted&, std::span<const StarTerm>, const Vec3d&, double&);

} // namespace orbis::sphere
