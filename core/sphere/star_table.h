// The triangles around each vertex, as one flat array.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::sphere {

// Corner of a triangle in a vertex' star: the triangle is (v, next, previous).
struct StarCorner {
  mesh::Index next, previous;
  std::uint32_t corner; // 3 * slot + the place of v in the triangle

  [[nodiscard]] std::uint32_t slot() const { return corner / 3; }
};

// Compressed sparse rows over vertex numbers; rows of vertices without live triangles are empty.
class StarTable {
public:
  // live: slots of the triangles to take. Rows list their corners in the order of `live`.
  void build(std::span<const mesh::Triangle> triangles, std::span<const std::uint32_t> live, std::size_t vertex_count);

  [[nodiscard]] std::span<const StarCorner> operator[](mesh::Index v) const {
    return std::span(corners_).subspan(first_[v], first_[v + 1] - first_[v]);
  }
  [[nodiscard]] std::size_t corners() const { return corners_.size(); }
  [[nodiscard]] std::size_t first(mesh::Index v) const {
    return first_[v];
  } // place of v's first corner in the whole table
  [[nodiscard]] std::uint32_t degree(mesh::Index v) const { return first_[v + 1] - first_[v]; }

private:
  std::vector<std::uint32_t> first_;
  std::vector<StarCorner> corners_;
};

} // namespace orbis::sphere
