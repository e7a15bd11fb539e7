#include "core/sphere/global_step.h"

#include <algorithm>
#include <limits>

#include "core/sphere/relaxation.h"
#include "core/sphere/untangle.h"

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 4096;
constexpr double residual_reduction = 0.05;
constexpr int most_halvings = 10, most_doublings = 2;
// The rest of the Hessian is made convex triangle by triangle. More of the exact one is not positive definite as a
// rule.
constexpr double exact_share = 0.4;

// a += t b
void add_scaled(std::vector<Tangent>& a, double t, const std::vector<Tangent>& b, mesh::ThreadPool& pool) {
  pool.for_blocks(a.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      a[i].x += t * b[i].x;
      a[i].y += t * b[i].y;
    }
  });
}

// a = t a + b
void scale_and_add(std::vector<Tangent>& a, double t, const std::vector<Tangent>& b, mesh::ThreadPool& pool) {
  pool.for_blocks(a.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) a[i] = {t * a[i].x + b[i].x, t * a[i].y + b[i].y};
  });
}

double inner(const std::vector<Tangent>& a, const std::vector<Tangent>& b, mesh::ThreadPool& pool) {
  return pool.sum_blocks(a.size(), grain, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i].x * b[i].x + a[i].y * b[i].y;
    return sum;
  });
}

} // namespace

GlobalStep::GlobalStep(const WholeLevel& level, HierarchicalBasis& basis, mesh::ThreadPool& pool)
    : level_(level), basis_(basis), pool_(pool) {}

StepOutcome step_along(const WholeLevel& level, std::span<const Tangent> direction, std::span<Vec3d> points,
                       std::vector<Vec3d>& trial, mesh::ThreadPool& pool) {
  const auto energy = [&](std::span<const Vec3d> at) {
    return total_energy(level.energy, level.triangles, level.references, at, pool);
  };
  const std::vector<Vec3d> start(points.begin(), points.end());
  trial.resize(points.size());
  const auto energy_at = [&](double t) {
    pool.for_blocks(start.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const TangentFrame frame(start[v]);
        trial[v] = normalized(start[v] + (t * direction[v].x) * frame.x + (t * direction[v].y) * frame.y);
      }
    });
    return untangle(level, start, trial, pool) ? energy(trial) : std::numeric_limits<double>::infinity();
  };
  StepOutcome out;
  double least = out.before = energy(points);
  const auto better = [&](double t) {
    const double now = energy_at(t);
    if (!(now < least)) return false;
    least = now;
    std::ranges::copy(trial, points.begin());
    out.length = t;
    return true;
  };
  double t = 1;
  for (int halving = 0; halving < most_halvings && !better(t); ++halving) t *= 0.5;
  for (int doubling = 0; doubling < most_doublings && out.length >= 1 && better(2 * out.length); ++doubling) {
  }
  out.gain = (out.before - least) / out.before;
  return out;
}

// Conjugate gradients for H step = -gradient; residual_ holds the right-hand side at first.
void GlobalStep::solve(std::uint32_t most_iterations) {
  std::ranges::fill(step_, Tangent{});
  basis_.apply(residual_, preconditioned_);
  direction_ = preconditioned_;
  double product = inner(residual_, preconditioned_, pool_);
  const double enough = product * residual_reduction * residual_reduction;
  for (std::uint32_t i = 0; i < most_iterations && product > enough; ++i) {
    hessian_.apply(direction_, image_, pool_);
    const double curvature = inner(direction_, image_, pool_);
    if (!(curvature > 0)) { // not convex that way: what was found so far is a direction of descent
      if (i == 0) step_ = direction_;
      break;
    }
    const double length = product / curvature;
    add_scaled(step_, length, direction_, pool_);
    add_scaled(residual_, -length, image_, pool_);
    basis_.apply(residual_, preconditioned_);
    const double next = inner(residual_, preconditioned_, pool_);
    scale_and_add(direction_, next / product, preconditioned_, pool_);
    product = next;
  }
}

StepOutcome GlobalStep::take(std::uint32_t most_iterations, std::span<Vec3d> points) {
  const std::size_t n = points.size();
  for (auto* vector : {&residual_, &step_, &direction_, &image_, &preconditioned_}) vector->resize(n);
  hessian_.build(level_.energy, level_.stars, level_.references, points, exact_share, pool_);
  tangent_gradient(level_.energy, level_.stars, level_.references, points, residual_, pool_);
  for (Tangent& r : residual_) r = {-r.x, -r.y};
  basis_.prepare(points);
  solve(most_iterations);

  return step_along(level_, step_, points, trial_, pool_);
}

} // namespace orbis::sphere
