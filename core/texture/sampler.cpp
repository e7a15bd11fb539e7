#include "core/texture/sampler.h"

#include <algorithm>
#include <cmath>

#include "core/float4.h"

namespace orbis::texture {
namespace {

constexpr double most_taps = 4;

// A coordinate into [0, size): where the wrap mode finds it. Done before the mip level divides it, so that an odd size
// repeats where it should.
double wrapped(double x, double size, Wrap wrap) {
  if (x >= 0 && x < size) return x;
  if (!std::isfinite(x)) return 0;
  if (wrap == Wrap::clamp) return x < 0 ? 0 : size;
  const double period = wrap == Wrap::repeat ? size : 2 * size;
  x -= period * std::floor(x / period);
  return wrap == Wrap::mirror && x > size ? period - x : x;
}

// The two texels that a place, in texels, lies between, and how far it is from the first to the second.
struct Between {
  std::uint32_t first, second;
  float part;
};

// at: in [0, size], wrapped already. Beside the image's edge lies, where it repeats, the other edge.
inline Between between(double at, std::uint32_t size, Wrap wrap) {
  const double from_first_centre = at - 0.5;
  // Rounded down: the sum is not negative. Faster than std::floor.
  const auto i = static_cast<std::int64_t>(at + 0.5) - 1; // NOLINT(bugprone-incorrect-roundings)
  const auto part = static_cast<float>(from_first_centre - static_cast<double>(i));
  if (i >= 0 && i + 1 < std::int64_t{size}) {
    const auto first = static_cast<std::uint32_t>(i);
    return {first, first + 1, part};
  }
  const std::int64_t last = std::int64_t{size} - 1;
  const auto edge = [&](std::int64_t k) {
    if (k < 0) return wrap == Wrap::repeat ? last : 0;
    if (k > last) return wrap == Wrap::repeat ? k - last - 1 : last;
    return k;
  };
  return {static_cast<std::uint32_t>(edge(i)), static_cast<std::uint32_t>(edge(i + 1)), part};
}

// value: of the first three channels, by their bytes.
inline Float4 texel(const Image& image, std::uint32_t x, std::uint32_t y, const std::array<float, 256>& value) {
  const std::uint8_t* p = image.at(x, y);
  return Float4{value[p[0]], value[p[1]], value[p[2]], image.channels == 4 ? srgb_tables.fraction[p[3]] : 1.0F};
}

} // namespace

Image halved(const Image& image, Encoding encoding) {
  Image half{(image.width + 1) / 2, (image.height + 1) / 2, image.channels, {}};
  half.pixels.resize(std::size_t{half.width} * half.height * half.channels);
  for (std::uint32_t y = 0; y < half.height; ++y)
    for (std::uint32_t x = 0; x < half.width; ++x) {
      const std::uint32_t x1 = std::min(2 * x + 1, image.width - 1), y1 = std::min(2 * y + 1, image.height - 1);
      Light sum{};
      for (const Light& light : {load(image, 2 * x, 2 * y, encoding), load(image, x1, 2 * y, encoding),
                                 load(image, 2 * x, y1, encoding), load(image, x1, y1, encoding)})
        for (std::size_t c = 0; c < 4; ++c) sum[c] += 0.25F * light[c];
      store(sum, half, x, y, encoding);
    }
  return half;
}

Footprint footprint_of(double texels) {
  Footprint footprint;
  while (texels > most_taps && footprint.level < 31) {
    texels /= 2;
    ++footprint.level;
  }
  // A bilinear read is a mean over two texels, at least half of that for its own.
  footprint.taps = static_cast<std::uint32_t>(std::max(std::ceil(texels - 0.5), 1.0));
  return footprint;
}

Sampler::Sampler(const Image& image, Wrap wrap_u, Wrap wrap_v, std::uint32_t levels, Encoding encoding)
    : image_(&image), wrap_u_(wrap_u), wrap_v_(wrap_v), encoding_(encoding) {
  const Image* last = &image;
  mips_.reserve(32);
  for (std::uint32_t level = 1; level < levels && (last->width > 1 || last->height > 1); ++level)
    last = &mips_.emplace_back(halved(*last, encoding));
}

Sampler::Level Sampler::level_at(std::uint32_t level) const {
  level = std::min(level, static_cast<std::uint32_t>(mips_.size()));
  if (level == 0) return {*image_, 1};
  return {mips_[level - 1], 1 / static_cast<double>(std::uint64_t{1} << level)};
}

Light Sampler::sample(double x, double y, std::uint32_t level) const { return between_texels(level_at(level), x, y); }

Light Sampler::mean(const Lattice& lattice, std::uint32_t level) const {
  const Level here = level_at(level);
  Light sum{};
  for (std::uint32_t j = 0; j < lattice.count_j; ++j)
    for (std::uint32_t i = 0; i < lattice.count_i; ++i) {
      const Light light = between_texels(here, lattice.x + i * lattice.di.x + j * lattice.dj.x,
                                         lattice.y + i * lattice.di.y + j * lattice.dj.y);
      for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
    }
  const float share = 1 / static_cast<float>(lattice.count_i * lattice.count_j);
  for (float& c : sum) c *= share;
  return sum;
}

inline Light Sampler::between_texels(const Level& level, double x, double y) const {
  const auto& [image, scale] = level;
  const Between across = between(scale * wrapped(x, image_->width, wrap_u_), image.width, wrap_u_);
  const Between down = between(scale * wrapped(y, image_->height, wrap_v_), image.height, wrap_v_);
  const std::array<float, 256>& value = encoding_ == Encoding::srgb ? srgb_tables.linear : srgb_tables.fraction;
  const Float4 a = texel(image, across.first, down.first, value), b = texel(image, across.second, down.first, value);
  const Float4 c = texel(image, across.first, down.second, value), d = texel(image, across.second, down.second, value);
  const Float4 top = a + across.part * (b - a), bottom = c + across.part * (d - c);
  const Float4 mean = top + down.part * (bottom - top);
  return {mean[0], mean[1], mean[2], mean[3]};
}

Light Sampler::nearest(double x, double y) const {
  const auto texel = [](double at, std::uint32_t size) {
    return std::min(static_cast<std::uint32_t>(std::max(at, 0.0)), size - 1);
  };
  return load(*image_, texel(wrapped(x, image_->width, wrap_u_), image_->width),
              texel(wrapped(y, image_->height, wrap_v_), image_->height), encoding_);
}

} // namespace orbis::texture
