// Triangles by the bands of rows that they reach into, so that threads can rasterise band by band, each in its cache.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/texture/raster.h"

namespace orbis::texture {

// The numbers of `count` triangles, for bands of all of them.
inline std::vector<std::uint32_t> all_triangles(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0U);
  return numbers;
}

// The triangles of each band, in the order in which they were given.
class Bands {
public:
  // triangles: numbers; corners(t): the three corners of one of them, in texels. Bands are `rows` rows of `height`.
  template <class Corners>
  Bands(std::span<const std::uint32_t> triangles, std::uint32_t height, std::uint32_t rows, Corners corners)
      : height_(height), rows_(rows), first_((height + rows - 1) / rows + 1, 0) {
    const auto for_bands = [&](std::uint32_t t, auto visit) {
      const std::array<RasterPoint, 3> p = corners(t);
      const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
      const double last = height - 1.0;
      const auto begin = static_cast<std::uint32_t>(std::clamp(low - 1, 0.0, last)) / rows;
      const auto end = static_cast<std::uint32_t>(std::clamp(high + 1, 0.0, last)) / rows;
      for (std::uint32_t b = begin; b <= end; ++b) visit(b);
    };
    for (const std::uint32_t t : triangles) for_bands(t, [&](std::uint32_t b) { ++first_[b + 1]; });
    for (std::size_t b = 0; b + 1 < first_.size(); ++b) first_[b + 1] += first_[b];
    triangles_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const std::uint32_t t : triangles) for_bands(t, [&](std::uint32_t b) { triangles_[next[b]++] = t; });
  }

  [[nodiscard]] std::size_t count() const { return first_.size() - 1; }
  // Its first row, and how many it has.
  [[nodiscard]] std::uint32_t top(std::size_t band) const { return static_cast<std::uint32_t>(band) * rows_; }
  [[nodiscard]] std::uint32_t rows(std::size_t band) const { return std::min(rows_, height_ - top(band)); }

  // Calls visit(t, corners) for the triangles of a band, with the corners counted from the band's first row.
  template <class Corners, class Visit> void for_each(std::size_t band, Corners corners, Visit visit) const {
    for (std::uint32_t i = first_[band]; i < first_[band + 1]; ++i) {
      std::array<RasterPoint, 3> p = corners(triangles_[i]);
      for (RasterPoint& corner : p) corner.y -= top(band); // exact: both are multiples of the smaller one's last place
      visit(triangles_[i], p);
    }
  }

private:
  std::uint32_t height_, rows_;
  std::vector<std::uint32_t> first_; // band -> its first entry; one past the end
  std::vector<std::uint32_t> triangles_;
};

} // namespace orbis::texture
