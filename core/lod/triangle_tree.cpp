#include "core/lod/triangle_tree.h"

#include <algorithm>
#include <limits>

namespace orbis::lod {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t deepest = 64; // of a tree that halves its triangles: more than 2^32 need

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
// Three times the centroid, along an axis.
double middle(const std::array<Vec3d, 3>& t, int axis) {
  return component(t[0], axis) + component(t[1], axis) + component(t[2], axis);
}

} // namespace

double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared_norm(ap);
  const Vec3d bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return squared_norm(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared_norm(ap - ab * (d1 - d3 > 0 ? d1 / (d1 - d3) : 0));
  const Vec3d cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return squared_norm(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared_norm(ap - ac * (d2 - d6 > 0 ? d2 / (d2 - d6) : 0));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double whole = (d4 - d3) + (d5 - d6);
    return squared_norm(bp - (c - b) * (whole > 0 ? (d4 - d3) / whole : 0));
  }
  const double scale = 1 / (va + vb + vc);
  return squared_norm(ap - ab * (vb * scale) - ac * (vc * scale));
}

double TriangleTree::Box::squared_distance(const Vec3d& p) const {
  const auto outside = [](double x, double from, double to) { return std::max({from - x, x - to, 0.0}); };
  const double x = outside(p.x, low.x, high.x), y = outside(p.y, low.y, high.y), z = outside(p.z, low.z, high.z);
  return x * x + y * y + z * z;
}

TriangleTree::TriangleTree(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles) {
  corners_.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) corners_.push_back({positions[a], positions[b], positions[c]});
  nodes_.reserve(triangles.size());
  build(0, static_cast<std::uint32_t>(corners_.size()));
}

// Halves at the median along the longest side of the box.
std::uint32_t TriangleTree::build(std::uint32_t first, std::uint32_t last) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::uint32_t i = first; i < last; ++i) {
    for (const Vec3d& p : corners_[i]) {
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
  }
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box, 0, first, last});
  if (last - first <= leaf_size) return node;
  const Vec3d size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = first + (last - first) / 2;
  std::nth_element(corners_.begin() + first, corners_.begin() + half, corners_.begin() + last,
                   [axis](const auto& s, const auto& t) { return middle(s, axis) < middle(t, axis); });
  build(first, half);
  const std::uint32_t right = build(half, last);
  nodes_[node].right = right;
  return node;
}

double TriangleTree::squared_distance(const Vec3d& p, double bound) const { return search(p, bound, -1); }

bool TriangleTree::is_within(const Vec3d& p, double bound) const {
  return search(p, std::numeric_limits<double>::infinity(), bound) <= bound;
}

double TriangleTree::search(const Vec3d& p, double bound, double enough) const {
  struct Waiting {
    std::uint32_t node;
    double distance;
  };
  std::array<Waiting, deepest> stack{Waiting{0, nodes_[0].box.squared_distance(p)}};
  std::size_t waiting = 1;
  double best = bound;
  while (waiting > 0 && best > enough) {
    const auto [i, distance] = stack[--waiting];
    if (distance >= best) continue;
    const Node& node = nodes_[i];
    if (node.right == 0) {
      for (std::uint32_t t = node.first; t < node.last; ++t)
        best = std::min(best, lod::squared_distance(p, corners_[t][0], corners_[t][1], corners_[t][2]));
      continue;
    }
    Waiting left{i + 1, nodes_[i + 1].box.squared_distance(p)};
    Waiting right{node.right, nodes_[node.right].box.squared_distance(p)};
    if (left.distance < right.distance) std::swap(left, right);
    stack[waiting++] = left; // the farther one waits longer
    stack[waiting++] = right;
  }
  return best;
}

} // namespace orbis::lod
