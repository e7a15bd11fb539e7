// The points as they are delivered: on the grid of multiples of 2^-24, where orientation is exact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/orientation.h"

namespace orbis::sphere {

struct Snapped {
  std::vector<GridPoint> points;
  std::uint64_t moved = 0;  // vertices that took a neighbouring grid point because the nearest one folded a triangle
  std::uint64_t folded = 0; // triangles that are still not positively oriented; 0 in a valid result
};

// Rounds every point to its nearest grid point. Where that folds a triangle, its vertices try the grid points around,
// up to a few units away, and take the first that makes their whole star positive. points: unit length.
[[nodiscard]] Snapped snap(std::span<const Vec3d> points, std::span<const mesh::Triangle> triangles);

} // namespace orbis::sphere
