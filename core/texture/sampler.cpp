#include "core/texture/sampler.h"

#include <algorithm>
#include <cmath>

namespace orbis::texture {
namespace {

constexpr double most_taps = 4;

// A coordinate into [0, size): where the wrap mode finds it. Done before the mip level divides it, so that an odd size
// repeats where it should.
double wrapped(double x, double size, Wrap wrap) {
  if (!std::isfinite(x)) return 0;
  if (wrap == Wrap::clamp) return std::clamp(x, 0.0, size);
  const double period = wrap == Wrap::repeat ? size : 2 * size;
  x -= period * std::floor(x / period);
  return wrap == Wrap::mirror && x > size ? period - x : x;
}

// The texel beside the image's edge: -1 or size, else itself.
std::uint32_t neighbour(std::int64_t i, std::uint32_t size, Wrap wrap) {
  if (wrap == Wrap::repeat) return static_cast<std::uint32_t>((i + size) % size);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, std::int64_t{size} - 1));
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
  footprint.taps = static_cast<std::uint32_t>(std::max(std::ceil(texels - 1e-3), 1.0));
  return footprint;
}

Sampler::Sampler(const Image& image, Wrap wrap_u, Wrap wrap_v, std::uint32_t levels, Encoding encoding)
    : image_(&image), wrap_u_(wrap_u), wrap_v_(wrap_v), encoding_(encoding) {
  const Image* last = &image;
  mips_.reserve(32);
  for (std::uint32_t level = 1; level < levels && (last->width > 1 || last->height > 1); ++level)
    last = &mips_.emplace_back(halved(*last, encoding));
}

Light Sampler::sample(double x, double y, std::uint32_t level) const {
  level = std::min(level, static_cast<std::uint32_t>(mips_.size()));
  const Image& image = level == 0 ? *image_ : mips_[level - 1];
  const double scale = 1.0 / static_cast<double>(std::uint64_t{1} << level);
  const double column = scale * wrapped(x, image_->width, wrap_u_) - 0.5;
  const double row = scale * wrapped(y, image_->height, wrap_v_) - 0.5;
  const double left = std::floor(column), top = std::floor(row);
  const auto s = static_cast<float>(column - left), t = static_cast<float>(row - top);
  const auto i = static_cast<std::int64_t>(left), j = static_cast<std::int64_t>(top);
  const std::uint32_t x0 = neighbour(i, image.width, wrap_u_), x1 = neighbour(i + 1, image.width, wrap_u_);
  const std::uint32_t y0 = neighbour(j, image.height, wrap_v_), y1 = neighbour(j + 1, image.height, wrap_v_);
  const Light a = load(image, x0, y0, encoding_), b = load(image, x1, y0, encoding_);
  const Light c = load(image, x0, y1, encoding_), d = load(image, x1, y1, encoding_);
  Light result{};
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = (1 - t) * ((1 - s) * a[k] + s * b[k]) + t * ((1 - s) * c[k] + s * d[k]);
  return result;
}

Light Sampler::nearest(double x, double y) const {
  const auto texel = [](double at, std::uint32_t size) {
    return std::min(static_cast<std::uint32_t>(std::max(at, 0.0)), size - 1);
  };
  return load(*image_, texel(wrapped(x, image_->width, wrap_u_), image_->width),
              texel(wrapped(y, image_->height, wrap_v_), image_->height), encoding_);
}

} // namespace orbis::texture
