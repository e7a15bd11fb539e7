// Numbered things by the group that each belongs to, such as triangles by page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace orbis::mesh {

class Groups {
public:
  Groups() = default;

  // group_of(item): the item's group; from `groups` on it belongs to none. O(items + groups).
  template <class GroupOf> Groups(std::size_t items, std::size_t groups, const GroupOf& group_of) : first_(groups + 1) {
    for (std::uint32_t i = 0; i < items; ++i)
      if (const std::size_t g = group_of(i); g < groups) ++first_[g + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    items_.resize(first_.back());
    std::vector<std::size_t> next = first_;
    for (std::uint32_t i = 0; i < items; ++i)
      if (const std::size_t g = group_of(i); g < groups) items_[next[g]++] = i;
  }

  // The items of a group, ascending.
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t group) const {
    return std::span(items_).subspan(first_[group], first_[group + 1] - first_[group]);
  }

private:
  std::vector<std::size_t> first_; // of a group, in items_; and their number
  std::vector<std::uint32_t> items_;
};

} // namespace orbis::mesh
