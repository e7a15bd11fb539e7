// The edges of a triangle soup, each with the half-edges that lie on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

// Half-edge 3 t + k runs from corner k of triangle t to corner (k + 1) mod 3.
struct EdgeSide {
  Index high;              // the larger of the edge's two vertices
  std::uint32_t half_edge; // 3 t + k
};

// Groups half-edges by their undirected edge. O(n) memory, 8 bytes a half-edge.
class EdgeTable {
public:
  // triangles: indices below vertex_count; fewer than 2^32 / 3 of them.
  EdgeTable(std::span<const Triangle> triangles, std::size_t vertex_count);

  // Calls visit(low, high, sides) once per edge, in ascending order of (low, high); sides are in ascending order too.
  template <class Visit> void for_each(Visit visit) const {
    for (Index low = 0; low + 1 < first_.size(); ++low) {
      for (std::uint32_t i = first_[low]; i < first_[low + 1];) {
        std::uint32_t j = i + 1;
        while (j < first_[low + 1] && sides_[j].high == sides_[i].high) ++j;
        visit(low, sides_[i].high, std::span(sides_).subspan(i, j - i));
        i = j;
      }
    }
  }

private:
  std::vector<std::uint32_t> first_; // vertex -> its first side in sides_, as the edge's lower vertex
  std::vector<EdgeSide> sides_;
};

} // namespace orbis::mesh
