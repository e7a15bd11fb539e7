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

// A triangle's block is a mixture. The convex one is that of energy_modes.h, for the triangle's plane: the bend of the
// sphere is neglected. The exact one has the derivatives of D and V (distortion_energy.h), which are linear in each
// corner; along a sphere they are, with p_i the corners and (i, j, k) cyclic,
//
//   D = sum cot_k (1 - p_i . p_j)    d2D/dp_i dp_j = -cot_k I            d2D/dp_i^2 = (cot_k p_i.p_j + cot_j p_i.p_k) I
//   V = det(p_i, p_j, p_k)           d2V/dp_i dp_j (u, v) = det(u, v, p_k)   d2V/dp_i^2 = -V I
//
// and for E = D h(V) the second derivative is h D'' + h' (D' V'^T + V' D'^T + D V'') + D h'' V' V'^T.
class TangentHessian {
public:
  using Block = std::array<float, 4>; // 2 x 2, row-major

  // stars: of all vertices of the finest level, and the same until apply.
  // exact_share: of the exact blocks, in [0, 1]; with 0 the whole is positive semi-definite.
  void build(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
             std::span<const Vec3d> points, double exact_share, mesh::ThreadPool& pool);

  [[nodiscard]] const Block& own(mesh::Index v) const { return own_[v]; }
  // at: place of a corner in the star table. The block of the corner's vertex (rows) and its `next` (columns).
  [[nodiscard]] const Block& neighbour(std::size_t at) const { return neighbour_[at]; }

  // out = H in, by vertex number.
  void apply(std::span<const Tangent> in, std::span<Tangent> out, mesh::ThreadPool& pool) const;

private:
  template <class Energy>
  void build_row(const Energy& energy, mesh::Index v, std::span<const Reference> references,
                 std::span<const Vec3d> points, double exact_share);

  const StarTable* stars_ = nullptr;
  std::vector<Block> own_;       // by vertex
  std::vector<Block> neighbour_; // by corner of the star table: the block of the vertex and the corner's `next`
};

// The exact gradient of the whole energy in the tangent planes.
void tangent_gradient(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                      std::span<const Vec3d> points, std::span<Tangent> out, mesh::ThreadPool& pool);

} // namespace orbis::sphere
