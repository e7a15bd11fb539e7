// How far a map is from the nearest local minimum of the symmetric Dirichlet energy: Newton's method on the finest
// level, with a sparse Cholesky factorisation, run until nothing is left to gain. Slow, and independent of the solver
// that it judges but for the energy itself.
#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::bench {

struct Reference {
  std::vector<Vec3d> points;
  double energy_before = 0, energy_after = 0; // 4 pi where isometric
  int steps = 0;
  bool converged = false; // the Newton decrement says that less than a millionth of the energy is left to gain
};

// points: unit length, every triangle positively oriented.
[[nodiscard]] Reference converge(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& points, int most_steps);

} // namespace orbis::bench
