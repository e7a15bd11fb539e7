// The input's textures, read for the texels of a page: through the input's texture coordinates, each texel the mean
// over its footprint in the source image.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/texture/bake.h"
#include "core/texture/sampler.h"
#include "core/texture/texel_map.h"

namespace orbis::texture {

// One texture of one of the input's materials.
struct TextureSource {
  const Image* image = nullptr;           // none: the flat color
  std::array<float, 4> color{1, 1, 1, 1}; // RGBA, linear; unused with an image
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false; // magnified without interpolation
  // KHR_texture_transform, row-major 2 x 3: u' = m0 u + m1 v + m2, v' = m3 u + m4 v + m5
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
};

// For each triangle of a page mesh the input's texture coordinates at its corners, before the transform: linear in
// each delivered triangle, as a renderer interpolates, so that what is baked is what the input showed.
using CornerUv = std::array<Vec2f, 3>;

class TextureReader {
public:
  // uv and source_of: one per triangle of the page's mesh; source_of counts in `sources`. Keeps references to all of
  // them. Mip levels are made as far as some triangle of `map` reads them.
  TextureReader(const TexelMap& map, std::span<const std::uint32_t> shown, std::span<const CornerUv> uv,
                std::span<const std::uint32_t> source_of, std::span<const TextureSource> sources, Encoding encoding);

  // What is constant in a triangle. Not to be used after its reader.
  struct Footprint {
    const TextureSource* source = nullptr;
    const Sampler* sampler = nullptr;
    std::array<RasterPoint, 3> corners; // in texels of the source
    std::uint32_t level = 0, taps_x = 1, taps_y = 1;
    std::array<double, 3> along_x{}, along_y{};
    // How far a texel's reads are from its centre, in weights; and the steps between them, in texels of the source.
    std::array<double, 3> reach{};
    RasterPoint step_x, step_y;
  };
  [[nodiscard]] Footprint footprint(std::uint32_t triangle, const TriangleInPage& place) const;

  // The mean over the texel whose centre has these weights: linear light or plain numbers, straight alpha. Reads only
  // points of the triangle: beyond a seam of the input's own atlas lies something else.
  [[nodiscard]] static Light read(const Footprint& f, const std::array<double, 3>& centre);

private:
  std::span<const CornerUv> uv_;
  std::span<const std::uint32_t> source_of_;
  std::span<const TextureSource> sources_;
  std::vector<Sampler> samplers_; // one for each image and its wrap modes; without an image one that is never read
  std::vector<std::size_t> sampler_of_; // by source
};

} // namespace orbis::texture
