// The low frequencies of a flat map: a warp of its square, by a grid.
#pragma once

#include <cstdint>
#include <vector>

#include "core/texture/plane_energy.h"

namespace orbis::texture {

// A cubic B-spline over a square grid, twice differentiable, so that it folds small triangles as rarely as it can.
class CoarseWarp {
public:
  // Fits the warp to a mesh on the unit square: where the mesh is, cell for cell, it lowers the energy of the mesh
  // under the warp, with each cell's surface taken as one. From coarse to fine grids, up to `cells` in each direction
  // (a power of two). The image is a rectangle of the surface's own size.
  CoarseWarp(const PlaneMesh& mesh, std::uint32_t cells);

  // at: in the unit square.
  [[nodiscard]] FlatPoint operator()(const FlatPoint& at) const;

private:
  std::uint32_t cells_ = 1;
  PlaneMesh grid_; // (cells + 1)^2 points, row by row; two triangles a cell

  [[nodiscard]] FlatPoint linear(const FlatPoint& at) const; // between the nodes
  [[nodiscard]] FlatPoint control(std::int64_t x, std::int64_t y) const;
  [[nodiscard]] std::uint32_t node(std::uint32_t x, std::uint32_t y) const { return y * (cells_ + 1) + x; }
};

} // namespace orbis::texture
