#include "core/texture/ray_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace orbis::texture {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t deepest = 64; // halving 2^32 triangles ends long before

Vec3f least(const Vec3f& a, const Vec3f& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3f most(const Vec3f& a, const Vec3f& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

// The part of a ray within one pair of parallel planes. An infinite `inverse` (a ray along them) gives infinities of
// the right sign, or no number on a plane, which std::min and std::max here leave out.
void clip(float low, float high, float origin, float inverse, float& from, float& to) {
  const float a = (low - origin) * inverse, b = (high - origin) * inverse;
  from = std::max(from, std::min(a, b));
  to = std::min(to, std::max(a, b));
}

} // namespace

class RayTree::Builder {
public:
  Builder(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles)
      : positions_(positions), input_(triangles), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (const auto& [a, b, c] : triangles)
      centres_.push_back((positions[a] + positions[b] + positions[c]) * (1.0F / 3));
    nodes_.emplace_back();
    split(0, 0, static_cast<std::uint32_t>(triangles.size()));
  }

  void split(std::uint32_t node, std::uint32_t first, std::uint32_t count);

  std::span<const Vec3f> positions_;
  std::span<const mesh::Triangle> input_;
  std::vector<std::uint32_t> order_; // of the triangles in the leaves
  std::vector<Vec3f> centres_;
  std::vector<Node> nodes_;
};

RayTree::RayTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles) {
  Builder builder(positions, triangles);
  nodes_ = std::move(builder.nodes_);
  for (const std::uint32_t t : builder.order_) {
    const Vec3f &a = positions[triangles[t][0]], &b = positions[triangles[t][1]], &c = positions[triangles[t][2]];
    triangles_.push_back({a, b - a, c - a});
  }
}

void RayTree::Builder::split(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f low{infinity, infinity, infinity}, high = -low, centre_low = low, centre_high = high;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const mesh::Index v : input_[order_[i]]) {
      low = least(low, positions_[v]);
      high = most(high, positions_[v]);
    }
    centre_low = least(centre_low, centres_[order_[i]]);
    centre_high = most(centre_high, centres_[order_[i]]);
  }
  nodes_[node] = {low, high, first, count};
  if (count <= leaf_size) return;

  const Vec3f size = centre_high - centre_low;
  float Vec3f::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3f::x
                             : size.y >= size.z                   ? &Vec3f::y
                                                                  : &Vec3f::z;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return centres_[a].*axis != centres_[b].*axis ? centres_[a].*axis < centres_[b].*axis : a < b;
  });
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = child;
  nodes_[node].count = 0;
  nodes_.emplace_back();
  nodes_.emplace_back();
  split(child, first, half);
  split(child + 1, first + half, count - half);
}

// Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997).
bool RayTree::meets(const Flat& t, const Vec3f& origin, const Vec3f& direction) {
  const Vec3f p = cross(direction, t.edge_2);
  const float determinant = dot(t.edge_1, p);
  if (determinant == 0) return false;
  const float inverse = 1 / determinant;
  const Vec3f from = origin - t.corner;
  const float u = dot(from, p) * inverse;
  if (u < 0 || u > 1) return false;
  const Vec3f q = cross(from, t.edge_1);
  const float v = dot(direction, q) * inverse;
  return v >= 0 && u + v <= 1 && dot(t.edge_2, q) * inverse > 0;
}

bool RayTree::meets(const Vec3f& origin, const Vec3f& direction) const {
  const Vec3f inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  std::array<std::uint32_t, deepest> waiting; // NOLINT: filled before it is read
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    float from = 0, to = std::numeric_limits<float>::infinity();
    clip(node.low.x, node.high.x, origin.x, inverse.x, from, to);
    clip(node.low.y, node.high.y, origin.y, inverse.y, from, to);
    clip(node.low.z, node.high.z, origin.z, inverse.z, from, to);
    if (from > to) continue;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (meets(triangles_[i], origin, direction)) return true;
    }
    if (node.count > 0) continue;
    waiting[count++] = node.first;
    waiting[count++] = node.first + 1;
  }
  return false;
}

} // namespace orbis::texture
