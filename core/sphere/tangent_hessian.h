// The Hessian of the whole map's energy in the vertices' tangent planes: the sum of its triangles'
// (triangle_hessian.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/hierarchical_basis.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"
#include "core/sphere/triangle_hessian.h"

namespace orbis::sphere {

class TangentHessian {
public:
  using Block = std::array<float, 4>; // 2 x 2, row-major

  // stars: of all vertices of the finest level, and the same until apply.
  // exact_share: of the exact Hessian, in [0, 1]; with 0 the whole is positive semi-definite.
  void build(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
             std::span<const Vec3d> points, double exact_share, mesh::ThreadPool& pool);

  [[nodiscard]] const Block& own(mesh::Index v) const { return own_[v]; }
  // at: place of a corner in the star table. The block of the corner's vertex (rows) and its `next` (columns).
  [[nodiscard]] const Block& neighbour(std::size_t at) const { return neighbour_[at]; }

  // out = H in, by vertex number.
  void apply(std::span<const Tangent> in, std::span<Tangent> out, mesh::ThreadPool& pool) const;

private:
  // The rows of the vertices [begin, end).
  template <class Energy>
  void build_rows(const Energy& energy, mesh::Index begin, mesh::Index end, std::span<const Reference> references,
                  std::span<const Vec3d> points, double exact_share);
  // k: place of the triangle in the star of v, its corner.
  void add_row(const TriangleHessian& part, std::size_t corner, mesh::Index v, std::size_t k);

  const StarTable* stars_ = nullptr;
  std::vector<Block> own_;       // by vertex
  std::vector<Block> neighbour_; // by corner of the star table: the block of the vertex and the corner's `next`
};

// The exact gradient of the whole energy in the tangent planes.
void tangent_gradient(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                      std::span<const Vec3d> points, std::span<Tangent> out, mesh::ThreadPool& pool);

} // namespace orbis::sphere
