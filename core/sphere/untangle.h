// Folds that a long step has made, taken out again where they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/whole_level.h"

namespace orbis::sphere {

// Moves the vertices around folded triangles until none is folded, and then to where their stars' energies are least.
//   before  the map without folds that the step started from: it tells how large the triangles should be
//   points  the map to be mended
// Between folded and not the energy is made finite: V is replaced by (V + sqrt(V^2 + eps^2)) / 2, which is positive and
// close to V where V > eps, and eps goes to 0 (Garanzha et al., Foldover-free maps in 50 lines of code, 2021). Returns
// whether no fold is left and every vertex is surrounded once; gives up where more than one triangle in a hundred is
// folded.
[[nodiscard]] bool untangle(const WholeLevel& level, std::span<const Vec3d> before, std::span<Vec3d> points,
                            mesh::ThreadPool& pool);

} // namespace orbis::sphere
