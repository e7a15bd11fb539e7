// A flow of the sphere that carries given points to others and everything else along.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/vec3.h"

namespace orbis::remesh {

// Where the flow takes `points`, unit vectors, when it takes from_i towards to_i along great circles. After Joshi and
// Miller, Landmark matching via large deformation diffeomorphisms (2000), one step after the other: at each moment the
// velocity is the field of least energy, for a Gaussian kernel as wide as half a radian, that moves every landmark
// towards its end. Such a field is smooth, and a flow along smooth fields is one-to-one, so nothing folds that is fine
// enough to follow it. Ends are met up to a thousandth of a radian, unless landmarks lie so close together, with ends
// so far apart, that no smooth field takes them there. Up to some hundred landmarks: O(steps (landmarks^3 + points
// landmarks)). The same on any number of threads.
[[nodiscard]] std::vector<Vec3d> carried(std::span<const Vec3d> points, std::span<const Vec3d> from,
                                         std::span<const Vec3d> to, mesh::ThreadPool& pool);

} // namespace orbis::remesh
