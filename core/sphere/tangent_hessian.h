// The Hessian of the whole map's energy in the vertices' tangent planes, made positive semi-definite triangle by
// triangle.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/hierarchical_basis.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {

// A triangle's block is that of energy_modes.h. The bend of the sphere under a triangle is neglected: this changes the
// direction of a step by the size of the triangles, and the gradient is the exact one.
class TangentHessian {
public:
  // stars: of all vertices of the finest level, and the same until apply.
  void build(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
             std::span<const Vec3d> points, mesh::ThreadPool& pool);

  // out = H in, by vertex number.
  void apply(std::span<const Tangent> in, std::span<Tangent> out, mesh::ThreadPool& pool) const;

private:
  using Block = std::array<float, 4>; // 2 x 2, row-major
  template <class Energy>
  void build_row(const Energy& energy, mesh::Index v, std::span<const Reference> references,
                 std::span<const Vec3d> points);

  const StarTable* stars_ = nullptr;
  std::vector<Block> own_;       // by vertex
  std::vector<Block> neighbour_; // by corner of the star table: the block of the vertex and the corner's `next`
};

// The exact gradient of the whole energy in the tangent planes.
void tangent_gradient(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                      std::span<const Vec3d> points, std::span<Tangent> out, mesh::ThreadPool& pool);

} // namespace orbis::sphere
