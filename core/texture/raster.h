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

// The texels of a row that a triangle covers, from `begin` to before `end`, and its barycentric weights there.
struct CoveredRow {
  std::uint32_t y = 0, begin = 0, end = 0;
  std::array<std::int64_t, 3> at_zero{}, step{}; // the edge functions at column 0, and what they lose by a column
  double scale = 0;                              // 1 / their sum

  // Of the centre of the texel in column x.
  [[nodiscard]] std::array<double, 3> weights(std::uint32_t x) const {
    std::array<double, 3> out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = scale * static_cast<double>(at_zero[k] - std::int64_t{x} * step[k]);
    return out;
  }
};

// Calls visit(row) for each row of the width x height grid in which the triangle covers the centre of a texel. A centre
// on an edge belongs to the triangle on one side of it only. Orientation does not matter. |coordinates| <= 2^14.
template <class Visit>
void rasterize_rows(const std::array<RasterPoint, 3>& corners, std::uint32_t width, std::uint32_t height, Visit visit) {
  constexpr std::int64_t one = std::int64_t{1} << raster_bits, half = one / 2;
  std::array<std::int64_t, 3> px{}, py{};
  for (std::size_t k = 0; k < 3; ++k) {
    px[k] = to_raster(corners[k].x);
    py[k] = to_raster(corners[k].y);
  }
  std::int64_t area = (px[1] - px[0]) * (py[2] - py[0]) - (px[2] - px[0]) * (py[1] - py[0]);
  if (area == 0) return;
  const std::int64_t sign = area < 0 ? -1 : 1;
  area *= sign;

  // The first centre that is not below `low`, and one past the last that is not above `high`.
  const auto first = [](std::int64_t low) { return std::max<std::int64_t>((low - half + one - 1) >> raster_bits, 0); };
  const auto end = [](std::int64_t high, std::uint32_t limit) {
    return std::min<std::int64_t>(((high - half) >> raster_bits) + 1, limit);
  };
  const auto [x_low, x_high] = std::minmax({px[0], px[1], px[2]});
  const auto [y_low, y_high] = std::minmax({py[0], py[1], py[2]});
  const std::int64_t x_first = first(x_low), x_end = end(x_high, width);
  const std::int64_t y_first = first(y_low), y_end = end(y_high, height);
  if (x_first >= x_end || y_first >= y_end) return;

  // Edge k goes from corner k + 1 to k + 2, or back, such that the triangle lies on its left; its function is the
  // weight of corner k, times the area: E(x, y) = dx (y - y0) - dy (x - x0), positive inside.
  CoveredRow row;
  row.scale = 1 / static_cast<double>(area);
  std::array<std::int64_t, 3> down{}, bias{};
  std::array<double, 3> inverse{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + 1) % 3, to = (k + 2) % 3;
    const std::int64_t dx = sign * (px[to] - px[from]), dy = sign * (py[to] - py[from]);
    const bool owns_its_points = dy > 0 || (dy == 0 && dx > 0); // and its reverse, in the neighbour, does not
    bias[k] = owns_its_points ? 0 : 1;
    down[k] = dx << raster_bits;
    row.step[k] = dy << raster_bits;
    inverse[k] = dy != 0 ? 1 / static_cast<double>(row.step[k]) : 0;
    row.at_zero[k] = dx * ((y_first << raster_bits) + half - py[from]) - dy * (half - px[from]);
  }

  for (std::int64_t y = y_first; y < y_end; ++y) {
    std::int64_t from = x_first, to = x_end;
    for (std::size_t k = 0; k < 3; ++k) {
      // Columns with slack - x step >= 0: a quotient says which, to the column beside; the integers decide.
      const std::int64_t slack = row.at_zero[k] - bias[k], step = row.step[k];
      const double quotient = static_cast<double>(slack) * inverse[k];
      const std::int64_t x =
          static_cast<std::int64_t>(std::clamp(quotient, static_cast<double>(x_first - 1), static_cast<double>(x_end)));
      const auto is_inside = [&](std::int64_t column) { return slack - column * step >= 0; };
      if (step > 0)
        to = std::min(to, is_inside(x + 1) ? x + 2 : is_inside(x) ? x + 1 : x);
      else if (step < 0)
        from = std::max(from, is_inside(x - 1) ? x - 1 : is_inside(x) ? x : x + 1);
      else if (slack < 0)
        to = from;
    }
    if (from < to) {
      row.y = static_cast<std::uint32_t>(y);
      row.begin = static_cast<std::uint32_t>(from);
      row.end = static_cast<std::uint32_t>(to);
      visit(row);
    }
    for (std::size_t k = 0; k < 3; ++k) row.at_zero[k] += down[k];
  }
}

// The same texel by texel: visit(x, y, weights).
template <class Visit>
void rasterize(const std::array<RasterPoint, 3>& corners, std::uint32_t width, std::uint32_t height, Visit visit) {
  rasterize_rows(corners, width, height, [&](const CoveredRow& row) {
    for (std::uint32_t x = row.begin; x < row.end; ++x) visit(x, row.y, row.weights(x));
  });
}

} // namespace orbis::texture
