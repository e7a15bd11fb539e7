// A conformal map of a sphere is free up to the Moebius maps of the sphere: turns, which change nothing that matters,
// and three degrees of freedom that move room from one side of the sphere to the other. This picks among them.
#pragma once

#include <span>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sphere/reference.h"

namespace orbis::sphere {

// Moves the points by Moebius maps until the area distortion is least: the variance of log(area on the sphere /
// reference area), weighted by reference area. Every step is checked: the variance falls and no triangle folds (a
// Moebius map takes great circles to other circles, which large triangles may not survive).
//   references  one per triangle
// Returns the variance that is left.
double centre_by_moebius(std::span<const mesh::Triangle> triangles, std::span<const Reference> references,
                         std::span<Vec3d> points, mesh::ThreadPool& pool);

} // namespace orbis::sphere
