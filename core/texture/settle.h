// From flat charts to delivered texture coordinates, on the grid on which orientation is exact.
#pragma once

#include <array>
#include <vector>

#include "core/texture/flat_charts.h"

namespace orbis::texture {

inline constexpr int uv_bits = 24;
using UvPoint = std::array<std::int32_t, 2>; // uv * 2^24

// +1 where the triangle is laid out as it is seen from outside the surface (clockwise in coordinates with v down), -1
// where it is folded over, 0 where it has no area. Exact.
[[nodiscard]] int orientation(const UvPoint& a, const UvPoint& b, const UvPoint& c);

// Twice the area of the triangle in grid units, with the sign of its orientation. Exact.
[[nodiscard]] std::int64_t doubled_area(const UvPoint& a, const UvPoint& b, const UvPoint& c);

// The float32 of a grid point, exactly.
[[nodiscard]] Vec2f to_uv(const UvPoint& p);

// Where a chart lies: a rectangle of a page, turned by a quarter or not.
struct ChartFrame {
  Chart chart{0, 0, 0, 0, 1, 1};
  Page page{1, 1};
  bool turned = false;
};

struct Settled {
  std::vector<UvPoint> points; // one per place
  std::uint64_t folded = 0;    // triangles that are not positively oriented; 0 in a valid atlas
};

// Rounds every place of a component's charts to the grid of its page. Where that folds a triangle, its corners try the
// grid points around, up to a few units away, and take the first that makes their whole star positive; places on a
// chart's side stay on it. frames: one per chart.
[[nodiscard]] Settled settle(const FlatCharts& charts, std::span<const ChartFrame> frames);

} // namespace orbis::texture
