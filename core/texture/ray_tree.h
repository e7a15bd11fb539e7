// Does a ray meet a surface? A binary tree of bounding boxes over its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::texture {

class RayTree {
public:
  // Splits at the median of the triangles' centres along the longest side of their box. O(n log n), deterministic.
  // triangles: at least one.
  RayTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles);

  // Whether a triangle is met by origin + s direction for some s > 0, from either side. A ray within a triangle's plane
  // does not meet it.
  [[nodiscard]] bool meets(const Vec3f& origin, const Vec3f& direction) const;

private:
  class Builder;
  // Inner nodes: children at `first` and first + 1. Leaves: triangles [first, first + count).
  struct Node {
    Vec3f low, high;
    std::uint32_t first = 0, count = 0;
  };
  // A corner and the two edges that leave it.
  struct Flat {
    Vec3f corner, edge_1, edge_2;
  };

  [[nodiscard]] static bool meets(const Flat& t, const Vec3f& origin, const Vec3f& direction);

  std::vector<Node> nodes_;
  std::vector<Flat> triangles_; // in the order of the leaves
};

} // namespace orbis::texture
