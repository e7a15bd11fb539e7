// Where nodes place meshes.
#pragma once

#include <array>
#include <vector>

#include "core/asset/asset.h"

namespace orbis::asset {

using Matrix3 = std::array<std::array<double, 3>, 3>; // [row][column]
[[nodiscard]] Matrix3 operator*(const Matrix3& a, const Matrix3& b);
// Whether it makes a right hand a left one.
[[nodiscard]] bool mirrors(const Matrix3& m);

// p -> linear p + offset
struct Placement {
  Matrix3 linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d offset{};

  [[nodiscard]] Vec3d operator()(const Vec3d& p) const;
  // First `inner`, then this one.
  [[nodiscard]] Placement after(const Placement& inner) const;
};

// What is scaled first, then turned by a unit quaternion (x, y, z, w), then moved.
[[nodiscard]] Placement placed(const Vec3d& translation, const std::array<double, 4>& rotation, const Vec3d& scale);

// Where the default scene shows each mesh of the document (without scenes: the nodes that have no parent), in the order
// of its nodes, at each instance of a node (EXT_mesh_gpu_instancing): the first 2^18 in all, then each node once. A
// mesh that it does not show, or that joints place, stays where it is. One or more for each mesh.
[[nodiscard]] std::vector<std::vector<Placement>> placements_of(const Asset& asset);

} // namespace orbis::asset
