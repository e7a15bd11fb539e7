// A tree of bounding boxes over triangles, to find the distance of a point from a surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::lod {

// The squared distance of p from the triangle (a, b, c), whatever its shape. Ericson, Real-Time Collision Detection
// (2005), section 5.1.5: by the Voronoi regions of corners, edges and inside.
[[nodiscard]] double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

class TriangleTree {
public:
  // triangles: indices into positions; at least one. Both are copied. O(n log n).
  TriangleTree(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles);

  // The squared distance of p from the nearest triangle, or `bound` if none is nearer than that.
  [[nodiscard]] double squared_distance(const Vec3d& p, double bound) const;
  // Whether some triangle is at most as far as `bound`, squared: cheaper than to find the nearest.
  [[nodiscard]] bool is_within(const Vec3d& p, double bound) const;

private:
  struct Box {
    Vec3d low, high;
    [[nodiscard]] double squared_distance(const Vec3d& p) const;
  };
  // An inner node has its left child behind it and its right child at `right`; a leaf has triangles [first, last).
  struct Node {
    Box box;
    std::uint32_t right = 0, first = 0, last = 0;
  };

  std::uint32_t build(std::uint32_t first, std::uint32_t last);
  // The squared distance of p from the nearest triangle, or from one that is at most as far as `enough`; `bound` if
  // none is nearer than that.
  [[nodiscard]] double search(const Vec3d& p, double bound, double enough) const;

  std::vector<std::array<Vec3d, 3>> corners_; // in the order of the leaves
  std::vector<Node> nodes_;
};

} // namespace orbis::lod
