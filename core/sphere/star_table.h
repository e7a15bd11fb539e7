// The triangles around each vertex, as one flat array.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"

namespace orbis::sphere {

// A triangle of a vertex' star: it is (v, next, the `next` of the corner that follows).
struct StarCorner {
  mesh::Index next;
  std::uint32_t corner; // 4 * triangle + the place of v in it

  [[nodiscard]] std::uint32_t triangle() const { return corner / 4; }
  [[nodiscard]] std::uint32_t place() const { return corner % 4; }
};

// Compressed sparse rows over vertex numbers. The corners of a row run counter-clockwise around the vertex, from its
// lowest triangle on, so the row depends on nothing but the triangles.
class StarTable {
public:
  // triangles: of a closed manifold, with vertices below vertex_count; at most 2^30.
  void build(std::span<const mesh::Triangle> triangles, std::size_t vertex_count, mesh::ThreadPool& pool);

  [[nodiscard]] std::span<const StarCorner> operator[](mesh::Index v) const {
    return std::span(corners_).subspan(first_[v], first_[v + 1] - first_[v]);
  }
  [[nodiscard]] std::size_t vertices() const { return first_.size() - 1; }
  [[nodiscard]] std::size_t corners() const { return corners_.size(); }
  // The place of v's first corner in the whole table.
  [[nodiscard]] std::size_t first(mesh::Index v) const { return first_[v]; }
  [[nodiscard]] std::uint32_t degree(mesh::Index v) const { return first_[v + 1] - first_[v]; }

private:
  void count_and_fill(std::span<const mesh::Triangle> triangles, mesh::ThreadPool& pool);

  std::vector<std::uint32_t> first_;
  std::vector<StarCorner> corners_;
};

// The third vertex of a star's triangle k.
[[nodiscard]] inline mesh::Index previous_in(std::span<const StarCorner> star, std::size_t k) {
  return star[k + 1 == star.size() ? 0 : k + 1].next;
}

} // namespace orbis::sphere
