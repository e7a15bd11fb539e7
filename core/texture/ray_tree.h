// Does a ray meet a surface? A tree of bounding boxes over its triangles, four to a node.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::texture {

// Where a ray meets a triangle.
struct RayHit {
  std::uint32_t triangle = 0;
  float u = 0, v = 0; // weights of its second and third corner
  bool from_behind = false;
};

class RayTree {
public:
  // Splits where the surface area heuristic finds it cheapest (MacDonald and Booth 1990; in bins, Wald 2007), then
  // takes binary nodes together by fours, whose boxes are tested side by side. O(n log n), deterministic.
  RayTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles);

  // Whether a triangle is met by origin + s direction for some s > 0, from either side. A ray within a triangle's plane
  // does not meet it.
  [[nodiscard]] bool meets(const Vec3f& origin, const Vec3f& direction) const;
  // The same, where some triangles let rays through. They are asked in no order.
  [[nodiscard]] bool meets(const Vec3f& origin, const Vec3f& direction,
                           const std::function<bool(const RayHit&)>& is_stopped) const;

private:
  class Builder;
  using Four [[gnu::vector_size(16)]] = float;

  // Four children. An inner one is node `first`; a leaf has `count` triangles from `first` on; without either, and with
  // an empty box, there is none.
  struct Node {
    std::array<Four, 3> low{}, high{}; // by axis
    std::array<std::uint32_t, 4> first{}, count{};
  };
  // A corner and the two edges that leave it.
  struct Flat {
    Vec3f corner, edge_1, edge_2;
  };

  template <class IsStopped>
  [[nodiscard]] static bool meets(const Flat& t, const Vec3f& origin, const Vec3f& direction, IsStopped is_stopped);
  template <class IsStopped>
  [[nodiscard]] bool meets_one(const Vec3f& origin, const Vec3f& direction, IsStopped is_stopped) const;

  std::vector<Node> nodes_;
  std::vector<Flat> triangles_;        // in the order of the leaves
  std::vector<std::uint32_t> numbers_; // what they are called
};

} // namespace orbis::texture
