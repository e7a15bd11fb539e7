#include "core/texture/ray_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace orbis::texture {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t bins = 16;
constexpr std::uint32_t deepest_by_area = 32; // from there on by the median: 32 more levels halve 2^32 triangles
constexpr std::size_t most_waiting = 256;     // 3 a level, and one
constexpr float infinity = std::numeric_limits<float>::infinity();

using Axis = float Vec3f::*;
constexpr std::array<Axis, 3> axes{&Vec3f::x, &Vec3f::y, &Vec3f::z};

struct Box {
  Vec3f low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

  void add(const Vec3f& p) {
    for (const Axis axis : axes) {
      low.*axis = std::min(low.*axis, p.*axis);
      high.*axis = std::max(high.*axis, p.*axis);
    }
  }
  void add(const Box& other) {
    add(other.low);
    add(other.high);
  }
  // Half of its surface; 0 of an empty box.
  [[nodiscard]] float area() const {
    const Vec3f d = high - low;
    return d.x >= 0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0;
  }
};

// Of the binary tree: children `first` and first + 1, or a leaf's triangles [first, first + count).
struct BinaryNode {
  Box box;
  std::uint32_t first = 0, count = 0;
};

} // namespace

class RayTree::Builder {
public:
  Builder(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles) : order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    boxes_.reserve(triangles.size());
    centres_.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      Box box;
      for (const mesh::Index v : {a, b, c}) box.add(positions[v]);
      boxes_.push_back(box);
      centres_.push_back((box.low + box.high) * 0.5F);
    }
    binary_.emplace_back();
    split(0, 0, static_cast<std::uint32_t>(triangles.size()), 0);
    out_.emplace_back();
    take_together(0, 0);
  }

  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; } // of the triangles in the leaves
  [[nodiscard]] std::vector<Node> take() { return std::move(out_); }

private:
  struct Cut {
    Axis axis = nullptr; // null: none
    float at = 0;        // centres below go left
    float cost = infinity;
  };

  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
  std::vector<Vec3f> centres_;
  std::vector<BinaryNode> binary_;
  std::vector<Node> out_;

  void split(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::uint32_t depth) {
    Box box, centres;
    for (std::uint32_t i = first; i < first + count; ++i) {
      box.add(boxes_[order_[i]]);
      centres.add(centres_[order_[i]]);
    }
    binary_[node] = {box, first, count};
    if (count <= leaf_size) return;
    const std::uint32_t left = depth < deepest_by_area ? divide(first, count, centres) : halve(first, count, centres);
    const auto child = static_cast<std::uint32_t>(binary_.size());
    binary_[node].first = child;
    binary_[node].count = 0;
    binary_.resize(binary_.size() + 2);
    split(child, first, left, depth + 1);
    split(child + 1, first + left, count - left, depth + 1);
  }

  // How many of the triangles, then in front, go left.
  std::uint32_t divide(std::uint32_t first, std::uint32_t count, const Box& centres) {
    Cut best;
    for (const Axis axis : axes) {
      const Cut cut = best_cut(first, count, centres, axis);
      if (cut.cost < best.cost) best = cut;
    }
    if (best.axis == nullptr) return halve(first, count, centres);
    const auto begin = order_.begin() + first;
    const auto middle =
        std::stable_partition(begin, begin + count, [&](std::uint32_t t) { return centres_[t].*best.axis < best.at; });
    const auto left = static_cast<std::uint32_t>(middle - begin);
    return left == 0 || left == count ? halve(first, count, centres) : left;
  }

  // Triangles times area on both sides is what a ray that meets the node has to expect.
  [[nodiscard]] Cut best_cut(std::uint32_t first, std::uint32_t count, const Box& centres, Axis axis) const {
    const float low = centres.low.*axis, size = centres.high.*axis - low;
    if (!(size > 0)) return {};
    struct Bin {
      Box box;
      std::uint32_t count = 0;
    };
    std::array<Bin, bins> filled;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const float place = (centres_[order_[i]].*axis - low) / size * static_cast<float>(bins);
      Bin& bin = filled[std::min(static_cast<std::size_t>(place), bins - 1)];
      bin.box.add(boxes_[order_[i]]);
      ++bin.count;
    }
    std::array<float, bins> behind{}; // cost of the bins from here on
    Bin sum;
    for (std::size_t b = bins - 1; b > 0; --b) {
      sum.box.add(filled[b].box);
      sum.count += filled[b].count;
      behind[b] = sum.box.area() * static_cast<float>(sum.count);
    }
    Cut best;
    sum = {};
    for (std::size_t b = 1; b < bins; ++b) {
      sum.box.add(filled[b - 1].box);
      sum.count += filled[b - 1].count;
      const float cost = sum.box.area() * static_cast<float>(sum.count) + behind[b];
      if (cost < best.cost) best = {axis, low + size * static_cast<float>(b) / static_cast<float>(bins), cost};
    }
    return best;
  }

  // At the median of the centres along the longest side of their box.
  std::uint32_t halve(std::uint32_t first, std::uint32_t count, const Box& centres) {
    const Vec3f size = centres.high - centres.low;
    const Axis axis = *std::ranges::max_element(axes, {}, [&](Axis a) { return size.*a; });
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      return centres_[a].*axis != centres_[b].*axis ? centres_[a].*axis < centres_[b].*axis : a < b;
    });
    return count / 2;
  }

  // The four binary nodes below this one that rays meet most: the largest are opened first.
  void take_together(std::uint32_t node, std::uint32_t root) {
    std::vector<std::uint32_t> children{root};
    while (children.size() < 4) {
      const auto opened = std::ranges::max_element(
          children, {}, [&](std::uint32_t c) { return binary_[c].count > 0 ? -1.0F : binary_[c].box.area(); });
      const BinaryNode& largest = binary_[*opened];
      if (largest.count > 0) break;
      *opened = largest.first;
      children.push_back(largest.first + 1);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const Box box = k < children.size() ? binary_[children[k]].box : Box{};
      for (std::size_t a = 0; a < 3; ++a) {
        out_[node].low[a][k] = box.low.*axes[a];
        out_[node].high[a][k] = box.high.*axes[a];
      }
      if (k >= children.size()) continue;
      const BinaryNode& child = binary_[children[k]];
      const auto next = static_cast<std::uint32_t>(out_.size());
      out_[node].count[k] = child.count;
      out_[node].first[k] = child.count > 0 ? child.first : next;
      if (child.count > 0) continue;
      out_.emplace_back();
      take_together(next, children[k]);
    }
  }
};

RayTree::RayTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles) {
  if (triangles.empty()) {
    nodes_.emplace_back();
    return;
  }
  Builder builder(positions, triangles);
  nodes_ = builder.take();
  numbers_.assign(builder.order().begin(), builder.order().end());
  triangles_.reserve(triangles.size());
  for (const std::uint32_t t : builder.order()) {
    const Vec3f &a = positions[triangles[t][0]], &b = positions[triangles[t][1]], &c = positions[triangles[t][2]];
    triangles_.push_back({a, b - a, c - a});
  }
}

// Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997). The determinant is -direction . normal.
// is_stopped(u, v, from_behind)
template <class IsStopped>
bool RayTree::meets(const Flat& t, const Vec3f& origin, const Vec3f& direction, IsStopped is_stopped) {
  const Vec3f p = cross(direction, t.edge_2);
  const float determinant = dot(t.edge_1, p);
  if (determinant == 0) return false;
  const float inverse = 1 / determinant;
  const Vec3f from = origin - t.corner;
  const float u = dot(from, p) * inverse;
  if (u < 0 || u > 1) return false;
  const Vec3f q = cross(from, t.edge_1);
  const float v = dot(direction, q) * inverse;
  return v >= 0 && u + v <= 1 && dot(t.edge_2, q) * inverse > 0 && is_stopped(u, v, determinant < 0);
}

bool RayTree::meets(const Vec3f& origin, const Vec3f& direction) const {
  return meets_one(origin, direction, [](std::uint32_t, float, float, bool) { return true; });
}

bool RayTree::meets(const Vec3f& origin, const Vec3f& direction,
                    const std::function<bool(const RayHit&)>& is_stopped) const {
  return meets_one(origin, direction, [&](std::uint32_t i, float u, float v, bool from_behind) {
    return is_stopped({numbers_[i], u, v, from_behind});
  });
}

// is_stopped(place of the triangle, u, v, from_behind)
template <class IsStopped>
bool RayTree::meets_one(const Vec3f& origin, const Vec3f& direction, IsStopped is_stopped) const {
  const Vec3f inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  std::array<std::uint32_t, most_waiting> waiting; // NOLINT: filled before it is read
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    // The part of the ray within each box. An infinite `inverse` (a ray along two planes) gives infinities of the right
    // sign, or no number on a plane, which the comparisons leave out.
    Four from{}, to = Four{} + infinity;
    for (std::size_t a = 0; a < 3; ++a) {
      const Four one = (node.low[a] - origin.*axes[a]) * inverse.*axes[a];
      const Four two = (node.high[a] - origin.*axes[a]) * inverse.*axes[a];
      const Four near = two < one ? two : one, far = one < two ? two : one;
      from = from < near ? near : from;
      to = far < to ? far : to;
    }
    const auto is_met = from <= to;
    for (std::size_t k = 0; k < 4; ++k) {
      if (is_met[k] == 0) continue;
      if (node.count[k] == 0 && node.first[k] != 0) waiting[count++] = node.first[k];
      for (std::uint32_t i = node.first[k]; i < node.first[k] + node.count[k]; ++i) {
        const auto here = [&](float u, float v, bool from_behind) { return is_stopped(i, u, v, from_behind); };
        if (meets(triangles_[i], origin, direction, here)) return true;
      }
    }
  }
  return false;
}

} // namespace orbis::texture
