// The triangles around each vertex of a flat mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::texture {

// A corner v of a triangle (v, next, previous).
struct StarCorner {
  mesh::Index next, previous;
  std::uint32_t corner; // 3 * triangle + the place of v in it
};

// Compressed sparse rows, in the order of the triangles.
class Stars {
public:
  Stars() = default;
  Stars(std::span<const mesh::Triangle> triangles, std::size_t vertex_count) : first_(vertex_count + 1, 0) {
    for (const mesh::Triangle& t : triangles)
      for (const mesh::Index v : t) ++first_[v + 1];
    for (std::size_t v = 0; v < vertex_count; ++v) first_[v + 1] += first_[v];
    corners_.resize(3 * triangles.size());
    std::vector<std::uint32_t> end(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k)
        corners_[end[triangles[t][k]]++] = {triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3], 3 * t + k};
  }

  [[nodiscard]] std::span<const StarCorner> operator[](mesh::Index v) const {
    return std::span(corners_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

private:
  std::vector<std::uint32_t> first_;
  std::vector<StarCorner> corners_;
};

} // namespace orbis::texture
