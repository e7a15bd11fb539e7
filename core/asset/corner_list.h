// Corners of faces as vertices: equal ones are one.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace orbis::asset {

// A primitive in the making. Corner: compares by ==; Hash: of a corner.
template <class Corner, class Hash> struct CornerList {
  std::unordered_map<Corner, std::uint32_t, Hash> number_of;
  std::vector<Corner> vertices;
  std::vector<std::uint32_t> indices;

  void add(const Corner& corner) {
    const auto [place, is_new] = number_of.try_emplace(corner, static_cast<std::uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(corner);
    indices.push_back(place->second);
  }
};

} // namespace orbis::asset
