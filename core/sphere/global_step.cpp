#include "core/sphere/global_step.h"

#include <algorithm>

#include "core/sphere/relaxation.h"

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 4096;
constexpr double residual_reduction = 0.05;
constexpr int most_halvings = 10;

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

GlobalStep::GlobalStep(const FinestLevel& level, HierarchicalBasis& basis, mesh::ThreadPool& pool)
    : level_(level), basis_(basis), pool_(pool) {}

double GlobalStep::energy(std::span<const Vec3d> points) {
  return total_energy(level_.energy, level_.triangles, level_.references, points, pool_);
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
    if (!(curvature > 0)) break; // rounding: the direction is used up
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
  trial_.resize(n);
  hessian_.build(level_.energy, level_.stars, level_.references, points, pool_);
  tangent_gradient(level_.energy, level_.stars, level_.references, points, residual_, pool_);
  for (Tangent& r : residual_) r = {-r.x, -r.y};
  basis_.prepare(points);
  solve(most_iterations);

  const double before = energy(points);
  double t = 1;
  for (int halving = 0; halving < most_halvings; ++halving, t *= 0.5) {
    pool_.for_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const TangentFrame frame(points[v]);
        trial_[v] = normalized(points[v] + (t * step_[v].x) * frame.x + (t * step_[v].y) * frame.y);
      }
    });
    const double after = energy(trial_);
    if (!(after < before)) continue;
    std::ranges::copy(trial_, points.begin());
    return {(before - after) / before, t};
  }
  return {};
}

} // namespace orbis::sphere
