// Reading an image between its texels: bilinear, in linear light or as plain numbers, on mip levels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/texture/bake.h"
#include "core/texture/color.h"
#include "core/texture/image.h"
#include "core/texture/raster.h"

namespace orbis::texture {

using Light = std::array<float, 4>; // linear RGB, straight alpha; of a data image its numbers in [0, 1]

[[nodiscard]] inline Light load(const Image& image, std::uint32_t x, std::uint32_t y,
                                Encoding encoding = Encoding::srgb) {
  const std::uint8_t* p = image.at(x, y);
  const std::array<float, 256>& value = encoding == Encoding::srgb ? srgb_tables.linear : srgb_tables.fraction;
  return {value[p[0]], value[p[1]], value[p[2]], image.channels == 4 ? srgb_tables.fraction[p[3]] : 1.0F};
}
inline void store(const Light& light, Image& image, std::uint32_t x, std::uint32_t y,
                  Encoding encoding = Encoding::srgb) {
  std::uint8_t* p = image.at(x, y);
  for (std::size_t c = 0; c < 3; ++c) p[c] = encoding == Encoding::srgb ? to_srgb(light[c]) : to_byte(light[c]);
  if (image.channels == 4) p[3] = to_byte(light[3]);
}

// Half as large in both directions (rounded up): each texel the mean of four.
[[nodiscard]] Image halved(const Image& image, Encoding encoding = Encoding::srgb);

// How a footprint of `texels` source texels across is averaged: on mip level `level` by `taps` reads in each direction.
struct Footprint {
  std::uint32_t level = 0, taps = 1;
};
[[nodiscard]] Footprint footprint_of(double texels);

class Sampler {
public:
  // Keeps a reference to the image. levels: how many mip levels may be read (1: the image itself), as far as there
  // are any.
  Sampler(const Image& image, Wrap wrap_u, Wrap wrap_v, std::uint32_t levels, Encoding encoding = Encoding::srgb);

  // x, y: in texels of the image itself (level 0), from its top left corner; any number, not finite counts as 0.
  [[nodiscard]] Light sample(double x, double y, std::uint32_t level) const;
  // The mean of reads in a lattice: count_i by count_j of them, from (x, y) on in steps of (di.x, di.y) and (dj.x,
  // dj.y).
  struct Lattice {
    double x = 0, y = 0;
    RasterPoint di, dj;
    std::uint32_t count_i = 1, count_j = 1;
  };
  [[nodiscard]] Light mean(const Lattice& lattice, std::uint32_t level) const;
  // The texel of the image itself that (x, y) lies in.
  [[nodiscard]] Light nearest(double x, double y) const;

private:
  struct Level {
    const Image& image;
    double scale;
  };
  [[nodiscard]] Level level_at(std::uint32_t level) const;
  [[nodiscard]] Light between_texels(const Level& level, double x, double y) const;

  const Image* image_;
  Wrap wrap_u_, wrap_v_;
  Encoding encoding_;
  std::vector<Image> mips_; // levels 1, 2, …
};

} // namespace orbis::texture
