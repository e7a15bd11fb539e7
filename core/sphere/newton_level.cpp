#include "core/sphere/newton_level.h"

#include "core/sphere/relaxation.h"

namespace orbis::sphere {
namespace {

// Tried in turn, until the matrix is positive definite. The whole of the exact Hessian hardly ever is; near the minimum
// a step with 0.7 of it gains twice what one without gains.
constexpr double first_share = 0.7, second_share = 0.4;
// Part of the mass matrix that is added: the energy does not resist turns of the whole sphere.
constexpr double shift = 0.01;

} // namespace

NewtonLevel::NewtonLevel(const WholeLevel& level, bool needed_convex, mesh::ThreadPool& pool)
    : level_(level), pool_(pool), exact_share_(needed_convex ? second_share : first_share),
      shifts_(level.stars.vertices(), 0), solver_(level.stars) {
  for (std::size_t t = 0; t < level.triangles.size(); ++t) {
    for (const mesh::Index v : level.triangles[t]) shifts_[v] += shift * double{level.references[t].area} / 3;
  }
}

bool NewtonLevel::factorise(std::span<const Vec3d> points) {
  hessian_.build(level_.energy, level_.stars, level_.references, points, exact_share_, pool_);
  return solver_.factorise(hessian_, shifts_);
}

double NewtonLevel::take(std::span<Vec3d> points) {
  while (!factorise(points)) {
    if (exact_share_ == 0) return 0; // rounding: the matrix is positive definite by construction
    exact_share_ = exact_share_ > second_share ? second_share : 0;
  }
  const std::size_t n = points.size();
  gradient_.resize(n);
  direction_.resize(n);
  tangent_gradient(level_.energy, level_.stars, level_.references, points, gradient_, pool_);
  for (std::size_t v = 0; v < n; ++v) direction_[v] = {-gradient_[v].x, -gradient_[v].y};
  solver_.solve(direction_);
  double slope = 0;
  for (std::size_t v = 0; v < n; ++v) slope += gradient_[v].x * direction_[v].x + gradient_[v].y * direction_[v].y;
  const double before = step_along(level_, direction_, points, trial_, pool_).before;
  return -0.5 * slope / before;
}

} // namespace orbis::sphere
