#include "core/remesh/sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace orbis::remesh {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr double rounding = 1e-12; // of unit vectors and what is computed of them
constexpr double infinity = std::numeric_limits<double>::infinity();

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Vec3d least(const Vec3d& a, const Vec3d& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3d most(const Vec3d& a, const Vec3d& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

} // namespace

bool SphereTree::Box::meets(const Box& other) const {
  return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
         low.z <= other.high.z && other.low.z <= high.z;
}

// A point sum w_i p_i of the flat triangle is pushed out by the factor 1 / |sum w_i p_i|. Since the p_i are unit,
// |sum w_i p_i|^2 = 1 - sum_{i<j} w_i w_j |p_i - p_j|^2 >= 1 - e^2 / 3, with e the longest edge.
SphereTree::Box SphereTree::box_of(const std::array<Vec3d, 3>& p) {
  const double e2 = std::max({squared_norm(p[1] - p[0]), squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2])});
  if (e2 > 2.5) return {{-1, -1, -1}, {1, 1, 1}};
  const double bulge = 1 / std::sqrt(1 - e2 / 3) - 1 + rounding;
  const Vec3d margin{bulge, bulge, bulge};
  return {least(p[0], least(p[1], p[2])) - margin, most(p[0], most(p[1], p[2])) + margin};
}

SphereTree::SphereTree(std::span<const Vec3d> points, std::span<const mesh::Triangle> triangles)
    : points_(points), triangles_(triangles) {
  items_.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    items_.push_back({box_of({points[a], points[b], points[c]}), t});
  }
  nodes_.reserve(triangles.size());
  build(0, static_cast<std::uint32_t>(items_.size()));
}

// Halves at the median along the longest side of the box.
std::uint32_t SphereTree::build(std::uint32_t first, std::uint32_t last) {
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::uint32_t i = first; i < last; ++i)
    box = {least(box.low, items_[i].box.low), most(box.high, items_[i].box.high)};
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box, 0, first, last});
  if (last - first <= leaf_size) return node;
  const Vec3d size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = first + (last - first) / 2;
  const auto middle = [axis](const Item& i) { return component(i.box.low, axis) + component(i.box.high, axis); };
  std::nth_element(items_.begin() + first, items_.begin() + half, items_.begin() + last,
                   [&](const Item& i, const Item& j) {
                     return middle(i) != middle(j) ? middle(i) < middle(j) : i.triangle < j.triangle;
                   });
  build(first, half);
  const std::uint32_t right = build(half, last);
  nodes_[node].right = right;
  return node;
}

Place SphereTree::locate(const Vec3d& d) const {
  Place best;
  double depth = -infinity;
  search({d, d}, [&](std::uint32_t t) {
    // det(d, a, b) by differences, which lose fewer digits.
    std::array<Vec3d, 3> from{};
    for (std::size_t k = 0; k < 3; ++k) from[k] = points_[triangles_[t][k]] - d;
    std::array<double, 3> weights{};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      weights[k] = dot(d, cross(from[(k + 1) % 3], from[(k + 2) % 3]));
      sum += weights[k];
    }
    if (!(sum > 0)) return;
    const double here = std::min({weights[0], weights[1], weights[2]}) / sum;
    if (here < depth || (here == depth && t > best.triangle)) return;
    depth = here;
    best = {t, {weights[0] / sum, weights[1] / sum, weights[2] / sum}};
  });
  if (depth == -infinity) throw Error(ErrorCode::internal, "a direction has no place on the sphere's triangles");
  double sum = 0;
  for (double& w : best.weights) sum += w = std::max(w, 0.0);
  for (double& w : best.weights) w /= sum;
  return best;
}

} // namespace orbis::remesh
