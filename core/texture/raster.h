// Which texels does a triangle cover? Decided in fixed point, so that triangles that share an edge share no texel and
// leave none out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace orbis::texture {

struct RasterPoint {
  double x = 0, y = 0; // texels; the texel (i, j) has its centre at (i + 0.5, j + 0.5)
};

// Corners are rounded to 2^-16 of a texel. With coordinates up to 2^14 the edge functions below fit 64 bits with a wide
// margin, so their signs are exact.
inline constexpr int raster_bits = 16;

// Rounded to nearest, halves up.
inline std::int64_t to_raster(double texels) {
  const double fixed = texels * (1 << raster_bits) + 0.5;
  const auto whole = static_cast<std::int64_t>(fixed);
  return whole - (static_cast<double>(whole) > fixed ? 1 : 0);
}

// Calls visit(x, y, weights) for each texel of the width x height grid whose centre lies in the triangle; weights are
// the barycentric coordinates of the centre. A centre on an edge belongs to the triangle on one side of it only.
// Orientation does not matter. |coordinates| <= 2^14.
template <class Visit>
void rasterize(const std::array<RasterPoint, 3>& corners, std::uint32_t width, std::uint32_t height, Visit visit) {
  constexpr std::int64_t one = std::int64_t{1} << raster_bits, half = one / 2;
  std::array<std::int64_t, 3> px{}, py{};
  for (std::size_t k = 0; k < 3; ++k) {
    px[k] = to_raster(corners[k].x);
    py[k] = to_raster(corners[k].y);
  }
  std::int64_t area = (px[1] - px[0]) * (py[2] - py[0]) - (px[2] - px[0]) * (py[1] - py[0]);
  if (area == 0) return;
  std::array<std::size_t, 3> order{0, 1, 2};
  if (area < 0) {
    area = -area;
    std::swap(order[1], order[2]);
  }

  // The first centre that is not below `low`, and one past the last that is not above `high`.
  const auto first = [](std::int64_t low) { return std::max<std::int64_t>((low - half + one - 1) >> raster_bits, 0); };
  const auto end = [](std::int64_t high, std::uint32_t limit) {
    return std::min<std::int64_t>(((high - half) >> raster_bits) + 1, limit);
  };
  const auto [x_low, x_high] = std::minmax({px[0], px[1], px[2]});
  const auto [y_low, y_high] = std::minmax({py[0], py[1], py[2]});
  const std::int64_t x_first = first(x_low), x_end = end(x_high, width);
  if (x_first >= x_end) return;

  // Edge k goes from corner order[k+1] to order[k+2]; its function is the weight of order[k], times the area:
  // E(x, y) = dx (y - y0) - dy (x - x0), positive inside.
  struct Edge {
    std::int64_t dx, dy, x0, y0, bias;
  };
  std::array<Edge, 3> edges{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = order[(k + 1) % 3], to = order[(k + 2) % 3];
    const std::int64_t dx = px[to] - px[from], dy = py[to] - py[from];
    const bool owns_its_points = dy > 0 || (dy == 0 && dx > 0); // and its reverse, in the neighbour, does not
    edges[k] = {dx, dy, px[from], py[from], owns_its_points ? 0 : 1};
  }

  // In a wide box each edge says by a division where its row of texels begins or ends; in a narrow one it is cheaper to
  // ask at every texel.
  constexpr std::int64_t narrow = 8;
  const bool divide = x_end - x_first > narrow;
  const double scale = 1 / static_cast<double>(area);
  for (std::int64_t y = first(y_low), y_end = end(y_high, height); y < y_end; ++y) {
    std::int64_t from = x_first, to = x_end;
    std::array<std::int64_t, 3> at_zero{}; // E at the centre of column 0
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge& e = edges[k];
      at_zero[k] = e.dx * ((y << raster_bits) + half - e.y0) - e.dy * (half - e.x0);
      if (!divide) continue;
      // at_zero - bias - x dy one >= 0
      const std::int64_t slack = at_zero[k] - e.bias, step = e.dy << raster_bits;
      const auto floor_of = [](std::int64_t n, std::int64_t d) { return n >= 0 ? n / d : -((-n + d - 1) / d); };
      if (step > 0) to = std::min(to, floor_of(slack, step) + 1);
      if (step < 0) from = std::max(from, -floor_of(slack, -step));
      if (step == 0 && slack < 0) to = from;
    }
    for (std::int64_t x = from; x < to; ++x) {
      const auto outside = [&](std::size_t k) { return at_zero[k] - edges[k].bias < x * (edges[k].dy << raster_bits); };
      if (!divide && (outside(0) || outside(1) || outside(2))) continue;
      std::array<double, 3> weights{};
      for (std::size_t k = 0; k < 3; ++k)
        weights[order[k]] = scale * static_cast<double>(at_zero[k] - x * (edges[k].dy << raster_bits));
      visit(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), weights);
    }
  }
}

} // namespace orbis::texture
