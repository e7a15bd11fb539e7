#include "core/sphere/newton_level.h"

#include <algorithm>

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
      mass_(level.stars.vertices(), 0) {
  for (std::size_t t = 0; t < level.triangles.size(); ++t) {
    for (const mesh::Index v : level.triangles[t]) mass_[v] += double{level.references[t].area} / 3;
  }
}

// Column by column: the blocks of v with itself and with its neighbours of higher number.
void NewtonLevel::assemble() {
  const std::size_t n = mass_.size();
  const auto size = static_cast<Eigen::Index>(2 * n);
  matrix_.resize(size, size);
  matrix_.reserve(static_cast<Eigen::Index>(3 * n + 2 * level_.stars.corners()));
  std::vector<std::pair<mesh::Index, const TangentHessian::Block*>> neighbours;
  for (std::size_t v = 0; v < n; ++v) {
    const auto vertex = static_cast<mesh::Index>(v);
    const TangentHessian::Block& own = hessian_.own(vertex);
    neighbours.clear();
    std::size_t at = level_.stars.first(vertex);
    for (const StarCorner& c : level_.stars[vertex]) {
      if (c.next > vertex) neighbours.emplace_back(c.next, &hessian_.neighbour(at));
      ++at;
    }
    std::ranges::sort(neighbours, {}, [](const auto& pair) { return pair.first; });
    const double mass = shift * mass_[v];
    for (int column = 0; column < 2; ++column) {
      const auto j = static_cast<Eigen::Index>(2 * v) + column;
      matrix_.startVec(j);
      matrix_.insertBack(j, j) = double{own[column == 0 ? 0 : 3]} + mass;
      if (column == 0) matrix_.insertBack(j + 1, j) = double{own[2]};
      for (const auto& [u, block] : neighbours) {
        const auto i = static_cast<Eigen::Index>(2 * std::size_t{u});
        const std::size_t first = column == 0 ? 0 : 2; // the block's row is v: it is seen from the other side
        matrix_.insertBack(i, j) = double{(*block)[first]};
        matrix_.insertBack(i + 1, j) = double{(*block)[first + 1]};
      }
    }
  }
  matrix_.finalize();
}

bool NewtonLevel::factorise(std::span<const Vec3d> points) {
  hessian_.build(level_.energy, level_.stars, level_.references, points, exact_share_, pool_);
  assemble();
  if (!analysed_) solver_.analyzePattern(matrix_);
  analysed_ = true;
  solver_.factorize(matrix_);
  return solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0;
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
  Eigen::VectorXd right(static_cast<Eigen::Index>(2 * n));
  for (std::size_t v = 0; v < n; ++v) {
    right[static_cast<Eigen::Index>(2 * v)] = -gradient_[v].x;
    right[static_cast<Eigen::Index>(2 * v) + 1] = -gradient_[v].y;
  }
  const Eigen::VectorXd d = solver_.solve(right);
  for (std::size_t v = 0; v < n; ++v) {
    direction_[v] = {d[static_cast<Eigen::Index>(2 * v)], d[static_cast<Eigen::Index>(2 * v) + 1]};
  }
  const double before = step_along(level_, direction_, points, trial_, pool_).before;
  return 0.5 * right.dot(d) / before;
}

} // namespace orbis::sphere
