#include "core/texture/disk_chart.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "core/texture/cut_writer.h"
#include "core/texture/outline.h"

namespace orbis::texture {
namespace {

using mesh::Index;
using mesh::Triangle;
using sphere::GridPoint;

GridPoint middle(const GridPoint& a, const GridPoint& b) {
  return sphere::to_grid(normalized(Vec3d(sphere::from_grid(a)) + Vec3d(sphere::from_grid(b))));
}

// Sphere to plane, with the middle of the surface in the middle.
class StereographicGuess {
public:
  StereographicGuess(std::span<const GridPoint> sphere, std::span<const Index> outline) {
    // The vector area of what an outline encloses; a point added to it changes nothing.
    Vec3d area;
    const auto at = [&](std::size_t i) { return Vec3d(sphere::from_grid(sphere[outline[i % outline.size()]])); };
    for (std::size_t i = 0; i < outline.size(); ++i)
      if (outline[i] < sphere.size() && outline[(i + 1) % outline.size()] < sphere.size())
        area += cross(at(i), at(i + 1));
    if (norm(area) > 0) axis_ = normalized(area);
    u_ = normalized(cross(axis_, std::abs(axis_.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    v_ = cross(axis_, u_);
  }
  FlatPoint operator()(const GridPoint& point) const {
    constexpr double least_depth = 0.05;
    const Vec3d p(sphere::from_grid(point));
    const double scale = 1 / std::max(1 + dot(p, axis_), least_depth);
    return {scale * dot(p, u_), scale * dot(p, v_)};
  }

private:
  Vec3d axis_{0, 0, 1}, u_, v_;
};

class DiskCutter {
public:
  // corners: of an outline of four vertices or more.
  DiskCutter(const AtlasComponent& component, Disk disk, const Corners& corners)
      : component_(component), disk_(std::move(disk)), corners_(corners), on_outline_(component.sphere.size()) {
    if (disk_.outline.size() == 3) add_corner();
  }

  std::optional<FlatCharts> run() {
    lay_outline();
    for (const std::uint32_t t : disk_.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (is_chord(from(t, k), from(t, k + 1))) split(t, k);
    std::sort(divided_.begin(), divided_.end());
    divided_.erase(std::unique(divided_.begin(), divided_.end()), divided_.end());
    std::vector<Division> divisions;
    for (const std::uint32_t t : divided_) {
      divisions.push_back(divide_at_middles(t));
      if (!is_sound(divisions.back())) return std::nullopt;
    }
    return write(divisions);
  }

private:
  // Of an outline's point: its place, and which sides it is on (bits), for corners two.
  struct OnOutline {
    unsigned sides = 0; // 0: not on the outline
    std::size_t number = 0;
    FlatPoint at;
  };

  const AtlasComponent& component_;
  Disk disk_;
  Corners corners_;
  std::vector<OnOutline> on_outline_;                        // point -> where
  std::unordered_map<std::uint64_t, std::uint32_t> middles_; // edge, lower vertex in the upper half -> point
  std::vector<GridPoint> added_;                             // the points in the middle of edges
  std::vector<std::uint32_t> divided_;                       // triangles

  static std::uint64_t key(Index a, Index b) { return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b); }

  // Where edge k of a triangle begins.
  [[nodiscard]] Index from(std::uint32_t triangle, std::size_t k) const {
    return component_.triangles[triangle][k % 3];
  }
  [[nodiscard]] Vec3d position(std::uint32_t point) const { return Vec3d(component_.positions[point]); }

  void split(std::uint32_t triangle, std::size_t edge) {
    const Index a = from(triangle, edge), b = from(triangle, edge + 1);
    divided_.push_back(triangle);
    const auto point = static_cast<std::uint32_t>(component_.sphere.size() + added_.size());
    if (!middles_.try_emplace(key(a, b), point).second) return;
    added_.push_back(middle(component_.sphere[a], component_.sphere[b]));
    on_outline_.emplace_back();
  }

  // An edge through the surface from one point of a side to another.
  [[nodiscard]] bool is_chord(Index a, Index b) const {
    if ((on_outline_[a].sides & on_outline_[b].sides) == 0) return false;
    const std::size_t i = on_outline_[a].number, j = on_outline_[b].number, n = disk_.outline.size();
    return (i + 1) % n != j && (j + 1) % n != i;
  }

  // A fourth corner in the middle of the longest of three edges.
  void add_corner() {
    std::vector<Index>& outline = disk_.outline;
    std::array<double, 3> lengths{};
    for (std::size_t i = 0; i < 3; ++i) lengths[i] = norm(position(outline[(i + 1) % 3]) - position(outline[i]));
    const auto longest = static_cast<std::size_t>(std::ranges::max_element(lengths) - lengths.begin());
    const Index a = outline[longest], b = outline[(longest + 1) % 3];
    for (const std::uint32_t t : disk_.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (from(t, k) == a && from(t, k + 1) == b) split(t, k);
    const auto point = static_cast<Index>(component_.sphere.size());
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(longest) + 1, point);
  }

  void lay_outline() {
    for (std::size_t i = 0; i < disk_.outline.size(); ++i) on_outline_[disk_.outline[i]].number = i;
    for (std::size_t side = 0; side < 4; ++side) lay_side(side, corners_[side], corners_[(side + 1) % 4]);
  }

  // Counter-clockwise as it is seen, from the lower left corner of the square; y down.
  static FlatPoint on_square(std::size_t side, double part) {
    switch (side) {
    case 0:
      return {part, 1};
    case 1:
      return {1, 1 - part};
    case 2:
      return {1 - part, 0};
    default:
      return {0, part};
    }
  }

  // By length; points at one place are kept apart.
  void lay_side(std::size_t side, std::size_t first, std::size_t last) {
    constexpr double least = 1e-3; // of the mean edge
    const std::size_t n = disk_.outline.size(), edges = (last + n - first) % n;
    std::vector<double> at{0};
    if (edges > 1) {
      for (std::size_t i = 0; i < edges; ++i)
        at.push_back(at.back() +
                     norm(position(disk_.outline[(first + i + 1) % n]) - position(disk_.outline[(first + i) % n])));
    } else {
      at.push_back(1);
    }
    const double mean = at.back() > 0 ? at.back() / static_cast<double>(edges) : 1;
    for (std::size_t i = 0; i <= edges; ++i) at[i] += static_cast<double>(i) * least * mean;
    for (std::size_t i = 0; i <= edges; ++i) {
      OnOutline& point = on_outline_[disk_.outline[(first + i) % n]];
      point.sides |= 1U << side;
      point.at = on_square(side, i == edges ? 1 : at[i] / at.back());
    }
  }

  [[nodiscard]] Division divide_at_middles(std::uint32_t t) const {
    Division out;
    std::array<std::uint32_t, 3> corner{};
    std::vector<std::size_t> middles; // edges that have one
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = from(t, k), b = from(t, k + 1);
      DividedPoint p{a, component_.sphere[a], 0, {}, static_cast<Site>(k)};
      p.barycentric[k] = 1;
      corner[k] = static_cast<std::uint32_t>(out.points.size());
      out.points.push_back(p);
      const auto found = middles_.find(key(a, b));
      if (found == middles_.end()) continue;
      middles.push_back(k);
      p = {found->second, added_[found->second - component_.sphere.size()], 0, {}, static_cast<Site>(k + 3)};
      p.barycentric[k] = p.barycentric[(k + 1) % 3] = 0.5;
      out.points.push_back(p);
    }
    const auto piece = [&out](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      out.pieces.push_back({{a, b, c}, 0});
    };
    const auto middle_of = [&](std::size_t k) { return corner[k] + 1; };
    if (middles.size() == 3) {
      for (std::size_t k = 0; k < 3; ++k) piece(corner[k], middle_of(k), middle_of((k + 2) % 3));
      piece(middle_of(0), middle_of(1), middle_of(2));
    } else {
      // From the first middle on, around: its edge's end, the other middle if there is one, ... to its edge's
      // beginning.
      const auto n = static_cast<std::uint32_t>(out.points.size());
      const std::uint32_t from = middle_of(middles.front());
      for (std::uint32_t i = 1; i + 1 < n; ++i) piece(from, (from + i) % n, (from + i + 1) % n);
    }
    return out;
  }

  [[nodiscard]] static bool is_sound(const Division& division) {
    return std::ranges::all_of(division.pieces, [&](const Piece& piece) {
      const auto& [a, b, c] = piece.points;
      return sphere::orientation(division.points[a].sphere, division.points[b].sphere, division.points[c].sphere) > 0;
    });
  }

  FlatCharts write(std::span<const Division> divisions) {
    CutWriter writer(component_, component_.sphere.size() + added_.size(), divided_.size());
    std::size_t next = 0;
    for (const std::uint32_t t : disk_.triangles) {
      if (next < divided_.size() && divided_[next] == t)
        writer.pieces(t, divisions[next++]);
      else
        writer.whole(t, 0);
    }
    WrittenCharts written = writer.take();
    const StereographicGuess guess(component_.sphere, disk_.outline);
    for (std::size_t p = 0; p < written.vertex.size(); ++p) {
      const OnOutline& outline = on_outline_[written.charts.mesh.vertices[written.vertex[p]].point];
      FlatPlace& place = written.charts.places[p];
      place.at = outline.sides == 0 ? guess(written.charts.mesh.vertices[written.vertex[p]].sphere) : outline.at;
      place.fixed_y = (outline.sides & 0b0101U) != 0;
      place.fixed_x = (outline.sides & 0b1010U) != 0;
    }
    return std::move(written.charts);
  }
};

} // namespace

std::optional<FlatCharts> cut_to_disk(const AtlasComponent& component, const Disk& disk, const Corners& corners) {
  return DiskCutter(component, disk, corners).run();
}

} // namespace orbis::texture
