// Things by the group that they belong to.
#include "core/mesh/groups.h"

#include <doctest/doctest.h>

#include <array>

using orbis::mesh::Groups;

namespace {

std::vector<std::uint32_t> items(const Groups& groups, std::size_t group) {
  return {groups[group].begin(), groups[group].end()};
}

} // namespace

TEST_CASE("each group has its items in their order; what belongs to no group is left out") {
  constexpr std::array<std::uint32_t, 7> group_of{2, 0, 9, 2, 0, 3, 2};
  const Groups groups(group_of.size(), 4, [&](std::uint32_t item) { return group_of[item]; });
  CHECK(items(groups, 0) == std::vector<std::uint32_t>{1, 4});
  CHECK(items(groups, 1).empty());
  CHECK(items(groups, 2) == std::vector<std::uint32_t>{0, 3, 6});
  CHECK(items(groups, 3) == std::vector<std::uint32_t>{5});
}

TEST_CASE("there may be nothing to group") {
  const Groups groups(0, 2, [](std::uint32_t) { return 0U; });
  CHECK(groups[0].empty());
  CHECK(groups[1].empty());
}
