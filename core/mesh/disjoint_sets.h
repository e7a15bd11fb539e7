// Disjoint sets (union-find) with path halving.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace orbis::mesh {

class DisjointSets {
public:
  explicit DisjointSets(std::size_t size) : parent_(size), count_(size) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  [[nodiscard]] std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // The smaller root becomes the representative, so that results do not depend on the order of the calls.
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[a < b ? b : a] = a < b ? a : b;
    --count_;
  }

  [[nodiscard]] std::size_t count() const { return count_; } // sets left

private:
  std::vector<std::uint32_t> parent_;
  std::size_t count_;
};

} // namespace orbis::mesh
