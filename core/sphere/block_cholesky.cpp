#include "core/sphere/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>

namespace orbis::sphere {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

using Block = std::array<double, 4>;

// a -= b c'
inline void subtract_product(Block& a, const Block& b, const Block& c) {
  a[0] -= b[0] * c[0] + b[1] * c[1];
  a[1] -= b[0] * c[2] + b[1] * c[3];
  a[2] -= b[2] * c[0] + b[3] * c[1];
  a[3] -= b[2] * c[2] + b[3] * c[3];
}

// a b for a symmetric b.
inline Block product(const Block& a, const Block& b) {
  return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]};
}

} // namespace

BlockCholesky::BlockCholesky(const StarTable& stars) : stars_(stars) {
  order();
  analyse();
}

void BlockCholesky::order() {
  const std::size_t n = stars_.vertices();
  Eigen::SparseMatrix<signed char, Eigen::ColMajor, int> graph(static_cast<int>(n), static_cast<int>(n)); // lower half
  graph.reserve(static_cast<Eigen::Index>(n + stars_.corners() / 2));
  std::vector<int> column;
  for (std::size_t v = 0; v < n; ++v) {
    column.assign(1, static_cast<int>(v));
    for (const StarCorner& c : stars_[static_cast<mesh::Index>(v)])
      if (c.next > v) column.push_back(static_cast<int>(c.next));
    std::ranges::sort(column);
    graph.startVec(static_cast<int>(v));
    for (const int row : column) graph.insertBack(row, static_cast<int>(v)) = 1;
  }
  graph.finalize();
  Eigen::AMDOrdering<int>::PermutationType permutation;
  Eigen::AMDOrdering<int>()(graph.selfadjointView<Eigen::Lower>(), permutation);
  vertex_.resize(n);
  row_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    vertex_[k] = static_cast<std::uint32_t>(permutation.indices()[static_cast<Eigen::Index>(k)]);
    row_[vertex_[k]] = static_cast<std::uint32_t>(k);
  }
}

// The elimination tree, and how many entries each column gets: row k has those columns from which a way up the tree
// leads from one of its own entries to k.
void BlockCholesky::analyse() {
  const std::size_t n = vertex_.size();
  parent_.assign(n, none);
  mark_.assign(n, none);
  std::vector<std::size_t> counts(n, 0);
  for (std::uint32_t k = 0; k < n; ++k) {
    mark_[k] = k;
    for (const StarCorner& c : stars_[vertex_[k]]) {
      for (std::uint32_t i = row_[c.next]; i < k && mark_[i] != k; i = parent_[i]) {
        if (parent_[i] == none) parent_[i] = k;
        ++counts[i];
        mark_[i] = k;
      }
    }
  }
  first_.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) first_[i + 1] = first_[i] + counts[i];
  rows_.resize(first_[n]);
  entries_.resize(first_[n]);
  inverse_pivots_.resize(n);
  pattern_.resize(n);
  work_.assign(n, {});
}

// Its blocks left of the diagonal go into work_, and the columns into pattern_; returns the one on the diagonal.
BlockCholesky::Block BlockCholesky::gather_row(std::uint32_t k, const TangentHessian& hessian, double shift) {
  const std::uint32_t v = vertex_[k];
  top_ = pattern_.size();
  mark_[k] = k;
  std::size_t at = stars_.first(v);
  for (const StarCorner& c : stars_[v]) {
    const TangentHessian::Block& block = hessian.neighbour(at++);
    std::uint32_t i = row_[c.next];
    if (i > k) continue;
    work_[i] = {block[0], block[1], block[2], block[3]};
    // The way up to what is known already, which then comes before that.
    std::size_t length = 0;
    for (; mark_[i] != k; i = parent_[i]) {
      pattern_[length++] = i;
      mark_[i] = k;
    }
    while (length > 0) pattern_[--top_] = pattern_[--length];
  }
  const TangentHessian::Block& own = hessian.own(v);
  return {own[0] + shift, own[1], own[2], own[3] + shift};
}

bool BlockCholesky::eliminate_row(std::uint32_t k, Block pivot) {
  for (std::size_t p = top_; p < pattern_.size(); ++p) {
    const std::uint32_t i = pattern_[p];
    const Block y = work_[i]; // this row's entry times the column's pivot
    work_[i] = {};
    const std::size_t begin = first_[i], end = begin + filled_[i];
    for (std::size_t e = begin; e < end; ++e) subtract_product(work_[rows_[e]], y, entries_[e]);
    const Block entry = product(y, inverse_pivots_[i]);
    subtract_product(pivot, entry, y);
    rows_[end] = k;
    entries_[end] = entry;
    ++filled_[i];
  }
  const double between = 0.5 * (pivot[1] + pivot[2]), determinant = pivot[0] * pivot[3] - between * between;
  if (!(pivot[0] > 0 && determinant > 0)) return false;
  inverse_pivots_[k] = {pivot[3] / determinant, -between / determinant, -between / determinant, pivot[0] / determinant};
  return true;
}

bool BlockCholesky::factorise(const TangentHessian& hessian, std::span<const double> shifts) {
  const auto n = static_cast<std::uint32_t>(vertex_.size());
  filled_.assign(n, 0);
  std::ranges::fill(mark_, none);
  for (std::uint32_t k = 0; k < n; ++k) {
    const Block pivot = gather_row(k, hessian, shifts[vertex_[k]]);
    if (!eliminate_row(k, pivot)) return false;
  }
  return true;
}

void BlockCholesky::solve(std::span<Tangent> right) {
  const std::size_t n = vertex_.size();
  permuted_.resize(n);
  for (std::size_t k = 0; k < n; ++k) permuted_[k] = right[vertex_[k]];
  for (std::size_t i = 0; i < n; ++i) {
    const Tangent x = permuted_[i];
    for (std::size_t e = first_[i]; e < first_[i + 1]; ++e) {
      const Block& l = entries_[e];
      permuted_[rows_[e]].x -= l[0] * x.x + l[1] * x.y;
      permuted_[rows_[e]].y -= l[2] * x.x + l[3] * x.y;
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    const Block& d = inverse_pivots_[i];
    Tangent x{d[0] * permuted_[i].x + d[1] * permuted_[i].y, d[2] * permuted_[i].x + d[3] * permuted_[i].y};
    for (std::size_t e = first_[i]; e < first_[i + 1]; ++e) {
      const Block& l = entries_[e];
      const Tangent& below = permuted_[rows_[e]];
      x.x -= l[0] * below.x + l[2] * below.y;
      x.y -= l[1] * below.x + l[3] * below.y;
    }
    permuted_[i] = x;
  }
  for (std::size_t k = 0; k < n; ++k) right[vertex_[k]] = permuted_[k];
}

} // namespace orbis::sphere
