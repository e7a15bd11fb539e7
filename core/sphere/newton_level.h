// Newton's method on one level of detail, with a sparse Cholesky factorisation: it takes the low frequencies all the
// way to their minimum, on levels where that costs little. Local steps move them by a vertex' width a sweep, and limbs
// that are too small on a coarse level stay so on every finer one.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/block_cholesky.h"
#include "core/sphere/global_step.h"

namespace orbis::sphere {

class NewtonLevel {
public:
  // level: all of it is kept by reference. needed_convex: whether the last such level was solved with none of the exact
  // Hessian only; then this one hardly allows most of it.
  NewtonLevel(const WholeLevel& level, bool needed_convex, mesh::ThreadPool& pool);

  // One step: solves for the direction with as much of the exact Hessian as leaves it positive definite, and goes along
  // it as step_along (global_step.h) does. Returns the part of the energy that the quadratic model had promised: an
  // estimate of what there is to gain, whatever the step's length.
  double take(std::span<Vec3d> points);

  // Whether a step was taken with none of the exact Hessian.
  [[nodiscard]] bool needed_convex() const { return exact_share_ == 0; }

private:
  [[nodiscard]] bool factorise(std::span<const Vec3d> points);

  const WholeLevel& level_;
  mesh::ThreadPool& pool_;
  TangentHessian hessian_;
  double exact_share_;
  std::vector<double> shifts_; // by vertex
  BlockCholesky solver_;
  std::vector<Tangent> gradient_, direction_;
  std::vector<Vec3d> trial_;
};

} // namespace orbis::sphere
