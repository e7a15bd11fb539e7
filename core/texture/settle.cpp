#include "core/texture/settle.h"

#include <algorithm>
#include <cmath>

#include "core/texture/stars.h"

namespace orbis::texture {
namespace {

constexpr int reach = 3;  // grid units that a point may move along each axis
constexpr int rounds = 8; // over the folded triangles

std::vector<UvPoint> offsets_by_distance() {
  std::vector<UvPoint> out;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      if (x != 0 || y != 0) out.push_back({x, y});
  std::stable_sort(out.begin(), out.end(), [](const UvPoint& a, const UvPoint& b) {
    return a[0] * a[0] + a[1] * a[1] < b[0] * b[0] + b[1] * b[1];
  });
  return out;
}

// A place that may not leave its chart's side moves along it only.
struct Freedom {
  bool x = true, y = true;
};

class Settler {
public:
  Settler(const FlatCharts& charts, std::span<const ChartFrame> frames)
      : triangles_(charts.triangles), offsets_(offsets_by_distance()) {
    for (const FlatPlace& place : charts.places) {
      const auto& [chart, page, turn] = frames[place.chart];
      const FlatPoint p = turn ? FlatPoint{1 - place.at.y, place.at.x} : place.at;
      const auto on_grid = [](double texel, std::uint32_t size) {
        return static_cast<std::int32_t>(std::llround(std::ldexp(texel / size, uv_bits)));
      };
      points_.push_back(
          {on_grid(chart.x + p.x * chart.width, page.width), on_grid(chart.y + p.y * chart.height, page.height)});
      freedom_.push_back(turn ? Freedom{!place.fixed_y, !place.fixed_x} : Freedom{!place.fixed_x, !place.fixed_y});
    }
  }

  Settled run() {
    std::vector<std::uint32_t> folded = folded_triangles();
    if (folded.empty()) return {std::move(points_), 0};
    stars_ = Stars(triangles_, points_.size());
    for (int round = 0; round < rounds && !folded.empty(); ++round) {
      bool moved = false;
      for (const std::uint32_t t : folded) moved = mend(t) || moved;
      if (!moved) break;
      folded = folded_triangles();
    }
    return {std::move(points_), folded.size()};
  }

private:
  std::span<const mesh::Triangle> triangles_;
  std::vector<UvPoint> offsets_, points_;
  std::vector<Freedom> freedom_;
  Stars stars_;

  [[nodiscard]] std::vector<std::uint32_t> folded_triangles() const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (orientation(points_[a], points_[b], points_[c]) != 1) out.push_back(t);
    }
    return out;
  }

  [[nodiscard]] auto folds(mesh::Index v, const UvPoint& at) const {
    return std::ranges::count_if(
        stars_[v], [&](const StarCorner& c) { return orientation(at, points_[c.next], points_[c.previous]) != 1; });
  }

  bool mend(std::uint32_t t) {
    return std::ranges::any_of(triangles_[t], [&](mesh::Index v) { return move(v); });
  }

  bool move(mesh::Index v) {
    const UvPoint old = points_[v];
    const auto before = folds(v, old);
    auto fewest = before;
    for (const UvPoint& d : offsets_) {
      if ((d[0] != 0 && !freedom_[v].x) || (d[1] != 0 && !freedom_[v].y)) continue;
      const UvPoint p{old[0] + d[0], old[1] + d[1]};
      const auto here = folds(v, p);
      if (here >= fewest) continue;
      fewest = here;
      points_[v] = p;
      if (here == 0) break;
    }
    return fewest < before;
  }
};

} // namespace

std::int64_t doubled_area(const UvPoint& a, const UvPoint& b, const UvPoint& c) {
  // Differences have 25 bits, products 50.
  return (std::int64_t{b[1]} - a[1]) * (std::int64_t{c[0]} - a[0]) -
         (std::int64_t{b[0]} - a[0]) * (std::int64_t{c[1]} - a[1]);
}

int orientation(const UvPoint& a, const UvPoint& b, const UvPoint& c) {
  const std::int64_t det = doubled_area(a, b, c);
  return (det > 0) - (det < 0);
}

Vec2f to_uv(const UvPoint& p) {
  return {std::ldexp(static_cast<float>(p[0]), -uv_bits), std::ldexp(static_cast<float>(p[1]), -uv_bits)};
}

Settled settle(const FlatCharts& charts, std::span<const ChartFrame> frames) { return Settler(charts, frames).run(); }

} // namespace orbis::texture
