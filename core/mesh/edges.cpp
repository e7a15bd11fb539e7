#include "core/mesh/edges.h"

#include <algorithm>

namespace orbis::mesh {

EdgeTable::EdgeTable(std::span<const Triangle> triangles, std::size_t vertex_count)
    : first_(vertex_count + 1, 0), sides_(triangles.size() * 3) {
  const auto for_each_half_edge = [&](auto visit) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax({triangles[t][k], triangles[t][(k + 1) % 3]});
        visit(low, EdgeSide{high, 3 * t + k});
      }
    }
  };
  // A counting sort by the lower vertex, then a short sort in each bucket.
  for_each_half_edge([&](Index low, EdgeSide) { ++first_[low + 1]; });
  for (std::size_t v = 0; v < vertex_count; ++v) first_[v + 1] += first_[v];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_half_edge([&](Index low, EdgeSide side) { sides_[next[low]++] = side; });
  for (std::size_t v = 0; v < vertex_count; ++v) {
    std::sort(sides_.begin() + first_[v], sides_.begin() + first_[v + 1], [](const EdgeSide& a, const EdgeSide& b) {
      return a.high != b.high ? a.high < b.high : a.half_edge < b.half_edge;
    });
  }
}

} // namespace orbis::mesh
