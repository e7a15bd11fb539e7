// One Newton step of all vertices together: it moves the low frequencies, which local steps hardly see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/hierarchical_basis.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"
#include "core/sphere/tangent_hessian.h"
#include "core/sphere/whole_level.h"

namespace orbis::sphere {

struct StepOutcome {
  double gain = 0;   // part of the energy
  double length = 0; // part of the direction that was taken: 1, 1/2, 1/4, … or 2, 4; 0 where none helped
  double before = 0; // the energy
};

// Goes along a direction: the whole way, or half of it and so on, until the folds that it made can be untangled and the
// energy falls; and on, twice as far, while it falls further. Where no step helps the points stay.
//   direction  one per vertex, in the frames of the points
//   trial      scratch
StepOutcome step_along(const WholeLevel& level, std::span<const Tangent> direction, std::span<Vec3d> points,
                       std::vector<Vec3d>& trial, mesh::ThreadPool& pool);

class GlobalStep {
public:
  GlobalStep(const WholeLevel& level, HierarchicalBasis& basis, mesh::ThreadPool& pool);

  // Solves for the Newton direction by preconditioned conjugate gradients (at most `most_iterations`; ends where the
  // residual has fallen to a twentieth in the preconditioner's norm), then goes along it (step_along).
  StepOutcome take(std::uint32_t most_iterations, std::span<Vec3d> points);

private:
  void solve(std::uint32_t most_iterations);

  WholeLevel level_;
  HierarchicalBasis& basis_;
  mesh::ThreadPool& pool_;
  TangentHessian hessian_;
  std::vector<Tangent> residual_, step_, direction_, image_, preconditioned_;
  std::vector<Vec3d> trial_;
};

} // namespace orbis::sphere
