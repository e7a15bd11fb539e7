#include "core/texture/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/edges.h"
#include "core/mesh/gluing.h"

namespace orbis::texture {
namespace {

using mesh::Index;
using mesh::Triangle;

double distance(const Vec3f& a, const Vec3f& b) { return norm(Vec3d(b) - Vec3d(a)); }

double length_of(std::span<const Index> loop, std::span<const Vec3f> positions) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    length += distance(positions[loop[i]], positions[loop[(i + 1) % loop.size()]]);
  return length;
}

// The longest of the loops at which the triangles end; empty where there is none.
std::vector<Index> longest_loop(std::span<const Triangle> triangles, std::span<const Vec3f> positions) {
  const mesh::Gluing gluing = mesh::glue_pairs(triangles, positions.size()).gluing;
  std::vector<Index> longest;
  double length = -1;
  for (const std::vector<std::uint32_t>& half_edges : mesh::boundary_loops(gluing)) {
    std::vector<Index> loop;
    loop.reserve(half_edges.size());
    for (const std::uint32_t h : half_edges) loop.push_back(gluing.from(h));
    const double own = length_of(loop, positions);
    if (own <= length) continue;
    length = own;
    longest = std::move(loop);
  }
  return longest;
}

// Whether each of the triangles that close holes closes another one than this loop.
std::vector<bool> close_others(std::span<const Triangle> closing, std::span<const Index> loop, std::size_t vertices) {
  mesh::DisjointSets sets(vertices); // holes have no vertex in common
  for (const auto& [a, b, c] : closing) {
    sets.unite(a, b);
    sets.unite(b, c);
  }
  std::vector<bool> out;
  out.reserve(closing.size());
  for (const Triangle& t : closing) out.push_back(sets.find(t[0]) != sets.find(loop.front()));
  return out;
}

// Vertices - edges + triangles is 1, and no vertex comes twice on the outline.
bool is_disk(std::span<const Triangle> triangles, std::vector<Index> outline, std::size_t vertices) {
  std::vector<bool> used(vertices, false);
  for (const Triangle& t : triangles)
    for (const Index v : t) used[v] = true;
  std::int64_t euler = std::count(used.begin(), used.end(), true) + static_cast<std::int64_t>(triangles.size());
  mesh::EdgeTable(triangles, vertices).for_each([&](Index, Index, std::span<const mesh::EdgeSide>) { --euler; });
  std::sort(outline.begin(), outline.end());
  return euler == 1 && std::adjacent_find(outline.begin(), outline.end()) == outline.end();
}

double angle_at(const Triangle& t, std::size_t k, std::span<const Vec3f> positions) {
  const Vec3d p(positions[t[k]]), a = Vec3d(positions[t[(k + 1) % 3]]) - p, b = Vec3d(positions[t[(k + 2) % 3]]) - p;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

constexpr double right_angle = std::numbers::pi / 2;

// Along an outline, once around from its first vertex.
class Course {
public:
  Course(const Disk& disk, const AtlasComponent& component) : size_(disk.outline.size()), at_(size_ + 1, 0) {
    const std::span<const Vec3f> positions = component.positions;
    for (std::size_t i = 0; i < size_; ++i)
      at_[i + 1] = at_[i] + distance(positions[disk.outline[i]], positions[disk.outline[(i + 1) % size_]]);
    std::vector<double> angle(positions.size(), 0); // of the surface, at its vertices
    for (const std::uint32_t t : disk.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        angle[component.triangles[t][k]] += angle_at(component.triangles[t], k, positions);
    turn_.push_back(0);
    for (const Index v : disk.outline) turn_.push_back(turn_.back() + std::numbers::pi - angle[v]);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double length() const { return at_.back(); }
  [[nodiscard]] double at(std::size_t i) const { return at_[i]; }
  // From vertex i on to vertex j.
  [[nodiscard]] double between(std::size_t i, std::size_t j) const {
    return j > i ? at_[j] - at_[i] : length() + at_[j] - at_[i];
  }
  // How much of a corner a vertex is: the left turn at it and around it, in windows from nothing to a twelfth of the
  // outline, each up to a right angle. The narrow windows tell the corner from its neighbours, the wide ones find it
  // where it is rounded off.
  [[nodiscard]] double sharpness(std::size_t i) const {
    constexpr std::array<double, 3> reaches{1.0 / 24, 1.0 / 100, 1.0 / 400}; // of the outline
    double sum = std::min(own_turn(i), right_angle);
    for (const double reach : reaches) sum += std::min(turn(i, reach * length()), right_angle);
    return sum / (1 + reaches.size());
  }
  [[nodiscard]] double own_turn(std::size_t i) const { return turn_[i + 1] - turn_[i]; }

private:
  std::size_t size_;
  std::vector<double> at_, turn_; // sums before each vertex

  // By how much the outline turns to the left within `reach` of a vertex; radians.
  [[nodiscard]] double turn(std::size_t i, double reach) const {
    return turned_until(at_[i] + reach, true) - turned_until(at_[i] - reach, false);
  }

  // The turns of all vertices before a place, which may lie before the beginning or behind the end.
  [[nodiscard]] double turned_until(double place, bool with_the_vertex_there) const {
    double rounds = 0;
    if (place < 0) rounds = -1;
    if (place >= length()) rounds = 1;
    place -= rounds * length();
    const auto end = at_.end() - 1;
    const auto i =
        with_the_vertex_there ? std::upper_bound(at_.begin(), end, place) : std::lower_bound(at_.begin(), end, place);
    return rounds * turn_.back() + turn_[static_cast<std::size_t>(i - at_.begin())];
  }
};

constexpr std::size_t most_sharp = 12, evenly_spaced = 12; // vertices that come into question
constexpr double surely_sharp = 1;                         // radians

// The first vertex at or behind a place on the outline.
std::size_t vertex_at(const Course& course, double place) {
  place = std::fmod(place, course.length());
  std::size_t i = 0;
  while (i + 1 < course.size() && course.at(i) < place) ++i;
  return i;
}

// The sharpest ones, and some all around. Of those close together one will do, but for true corners: a long strip has
// two at each end.
std::vector<std::size_t> candidates(const Course& course, std::span<const double> sharpness) {
  std::vector<std::size_t> by_sharpness(course.size());
  std::iota(by_sharpness.begin(), by_sharpness.end(), std::size_t{0});
  std::stable_sort(by_sharpness.begin(), by_sharpness.end(),
                   [&](std::size_t i, std::size_t j) { return sharpness[i] > sharpness[j]; });
  const double reach = course.length() / 24;
  std::vector<std::size_t> out;
  for (const std::size_t i : by_sharpness) {
    if (out.size() == most_sharp) break;
    const bool stands_alone = std::ranges::none_of(out, [&](std::size_t j) {
      return std::min(course.between(i, j), course.between(j, i)) <= reach &&
             !(course.own_turn(i) > surely_sharp && course.own_turn(j) > surely_sharp);
    });
    if (stands_alone) out.push_back(i);
  }
  const double start = course.at(by_sharpness.front()); // not where the outline happens to begin
  for (std::size_t k = 0; k < evenly_spaced && course.length() > 0; ++k)
    out.push_back(vertex_at(course, start + course.length() * static_cast<double>(k) / evenly_spaced));
  for (std::size_t i = 0; i < std::min<std::size_t>(course.size(), 4); ++i) out.push_back(i); // four at least
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

double squared_log(double ratio) { return std::log(ratio) * std::log(ratio); }

// Four right angles and equal opposite sides have 2 pi, the most; a square a little more than a long rectangle.
double fitness(const Course& course, std::span<const double> sharpness, const Corners& corners) {
  constexpr double weight_of_shape = 0.02, most_for_shape = 0.2;
  const double least = 1e-6 * course.length();
  std::array<double, 4> sides{};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    sides[k] = std::max(course.between(corners[k], corners[(k + 1) % 4]), least);
    sum += sharpness[corners[k]];
  }
  if (!(least > 0)) return sum;
  const double shape = squared_log((sides[0] + sides[2]) / (sides[1] + sides[3]));
  return sum - squared_log(sides[0] / sides[2]) - squared_log(sides[1] / sides[3]) -
         std::min(weight_of_shape * shape, most_for_shape);
}

// Whether some corner of one set has none of the other's near it.
bool differ(const Course& course, const Corners& a, const Corners& b) {
  const double near = course.length() / 48;
  return std::ranges::any_of(a, [&](std::size_t i) {
    return std::ranges::all_of(
        b, [&](std::size_t j) { return i != j && std::min(course.between(i, j), course.between(j, i)) > near; });
  });
}

} // namespace

std::optional<Disk> as_disk(const AtlasComponent& component) {
  if (component.delivered == component.triangles.size()) return std::nullopt; // closed
  const std::span<const Triangle> delivered = component.triangles.first(component.delivered);
  Disk out;
  out.outline = longest_loop(delivered, component.positions);
  if (out.outline.size() < 3) return std::nullopt;
  double area = 0;
  for (const auto& [a, b, c] : delivered) {
    const Vec3d p(component.positions[a]), q(component.positions[b]), r(component.positions[c]);
    area += 0.5 * norm(cross(q - p, r - p));
  }
  const double length = length_of(out.outline, component.positions);
  out.openness = area > 0 ? length * length / (4 * std::numbers::pi * area) : 0;
  const std::vector<bool> stays =
      close_others(component.triangles.subspan(component.delivered), out.outline, component.positions.size());
  std::vector<Triangle> triangles;
  for (std::uint32_t t = 0; t < component.triangles.size(); ++t) {
    if (t >= component.delivered && !stays[t - component.delivered]) continue;
    out.triangles.push_back(t);
    triangles.push_back(component.triangles[t]);
  }
  if (!is_disk(triangles, out.outline, component.positions.size())) return std::nullopt;
  return out;
}

std::vector<Corners> corners_of(const Disk& disk, const AtlasComponent& component, std::size_t most) {
  const Course course(disk, component);
  std::vector<double> sharpness;
  sharpness.reserve(course.size());
  for (std::size_t i = 0; i < course.size(); ++i) sharpness.push_back(course.sharpness(i));
  const std::vector<std::size_t> all = candidates(course, sharpness);
  std::vector<std::pair<double, Corners>> sets;
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b)
      for (std::size_t c = b + 1; c < all.size(); ++c)
        for (std::size_t d = c + 1; d < all.size(); ++d) {
          const Corners corners{all[a], all[b], all[c], all[d]};
          sets.emplace_back(fitness(course, sharpness, corners), corners);
        }
  std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Corners> out;
  for (const auto& candidate : sets) {
    if (out.size() == most) break;
    const Corners& corners = candidate.second;
    if (std::ranges::all_of(out, [&](const Corners& other) { return differ(course, corners, other); }))
      out.push_back(corners);
  }
  return out;
}

} // namespace orbis::texture
