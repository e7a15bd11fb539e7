// A sparse Cholesky factorisation of matrices of 2 x 2 blocks, one block for each pair of neighbouring vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/sphere/star_table.h"
#include "core/sphere/tangent_hessian.h"

namespace orbis::sphere {

// P H P' = L D L' with unit lower triangular L, row by row (the up-looking algorithm of Davis 2006, section 4.7, on
// blocks). A block has one index for four numbers, which are multiplied with each other: a factorisation number by
// number takes three times as long and a third more memory. P is an approximate minimum degree ordering (Amestoy, Davis
// and Duff 1996, by Eigen) of the vertices.
class BlockCholesky {
public:
  // stars: of the vertices; they say which blocks there are. Kept by reference.
  explicit BlockCholesky(const StarTable& stars);

  // Of hessian + diag(shifts), with a shift for both unknowns of each vertex. False where that is not positive
  // definite.
  [[nodiscard]] bool factorise(const TangentHessian& hessian, std::span<const double> shifts);
  // right: by vertex; becomes the solution. After a factorisation that was possible.
  void solve(std::span<Tangent> right);

private:
  using Block = std::array<double, 4>; // row by row

  void order();
  void analyse();
  [[nodiscard]] Block gather_row(std::uint32_t k, const TangentHessian& hessian, double shift);
  [[nodiscard]] bool eliminate_row(std::uint32_t k, Block pivot);

  const StarTable& stars_;
  std::vector<std::uint32_t> vertex_; // row -> vertex
  std::vector<std::uint32_t> row_;    // and back
  std::vector<std::uint32_t> parent_; // in the elimination tree
  std::vector<std::size_t> first_;    // column of L -> its first entry
  std::vector<std::uint32_t> filled_; // column of L -> its entries so far
  std::vector<std::uint32_t> rows_;   // of the entries
  std::vector<Block> entries_;
  std::vector<Block> inverse_pivots_;
  // Of the row in work: its columns, from `top_` on with every column before its parent, and its blocks.
  std::vector<std::uint32_t> pattern_, mark_;
  std::size_t top_ = 0;
  std::vector<Block> work_;
  std::vector<Tangent> permuted_;
};

} // namespace orbis::sphere
