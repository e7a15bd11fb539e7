// Which triangles of a shape are seen at each sub-pixel.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/texture/bands.h"
#include "core/texture/projection.h"
#include "core/texture/sampler.h"
#include "core/texture/shape.h"

namespace orbis::texture {

// The base colours of a shape's triangles as they lie on the screen.
class BaseColors {
public:
  // Keeps references to all of them. samplers: one per page of the atlas, with mip_levels levels.
  BaseColors(const Shape& shape, std::span<const Projected> points, std::span<const Sampler> samplers)
      : shape_(shape), points_(points), samplers_(samplers) {}

  static constexpr std::uint32_t mip_levels = 6;

  // What is constant in a triangle.
  struct InTriangle {
    const Sampler* sampler = nullptr;
    const Material* material = nullptr;
    std::array<RasterPoint, 3> in_page;
    double mip_level = 0;

    // b, c: weights of the second and third corner, in space. Linear light, straight alpha.
    [[nodiscard]] Light at(double b, double c) const;
  };
  [[nodiscard]] InTriangle operator[](std::uint32_t triangle) const;

private:
  const Shape& shape_;
  std::span<const Projected> points_;
  std::span<const Sampler> samplers_;
};

// A triangle that is seen at a sub-pixel.
struct Fragment {
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
  float inverse_depth = 0; // 0: none
  float b = 0, c = 0;      // weights of its second and third corner, in space
};

// What shines through, nearest first. Eight sheets of which each hides half leave 0.4 % of what is behind.
using Layers = std::array<Fragment, 8>;

// A band of rows of sub-pixels, row by row.
struct FragmentRows {
  std::vector<Fragment> solid; // what hides all that is behind it
  std::vector<Layers> layers;  // empty where the band has none; some may lie behind the solid one
};

// The triangles that show the viewer a side that is drawn, in ascending order.
[[nodiscard]] std::vector<std::uint32_t> facing_viewer(const Shape& shape, std::span<const Projected> points);

// width: of the viewport, in sub-pixels. bands: of the triangles that are drawn.
[[nodiscard]] FragmentRows find_visible(const Shape& shape, const Bands& bands, std::size_t band,
                                        std::span<const Projected> points, std::uint32_t width,
                                        const BaseColors& base_colors);

} // namespace orbis::texture
