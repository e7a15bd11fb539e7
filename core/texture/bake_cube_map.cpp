#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/error.h"
#include "core/texture/bake.h"
#include "core/texture/sampler.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t report_interval = 32; // rows

// Face coordinates to texels of a face's image.
std::array<double, 2> texel_of(const Image& image, const FacePoint& p) {
  return {0.5 * (p.u + 1) * image.width, 0.5 * (p.v + 1) * image.height};
}

// A face's image with a frame of what lies beyond its border on the neighbours, so that reads across it see no edge.
Image framed(std::span<const Image> images, Face f, std::uint32_t frame) {
  const Image& inner = images[f];
  Image outer{inner.width + 2 * frame, inner.height + 2 * frame, 4, {}};
  outer.pixels.resize(std::size_t{outer.width} * outer.height * outer.channels);
  std::vector<Sampler> samplers;
  for (const Image& image : images) samplers.emplace_back(image, Wrap::clamp, Wrap::clamp, 1);
  for (std::uint32_t y = 0; y < outer.height; ++y)
    for (std::uint32_t x = 0; x < outer.width; ++x) {
      const std::uint32_t column = x - frame, row = y - frame; // wraps around to large numbers outside
      if (column < inner.width && row < inner.height) {
        store(load(inner, column, row), outer, x, y);
        continue;
      }
      const Vec3d beyond =
          direction(f, {2 * (x + 0.5 - frame) / inner.width - 1, 2 * (y + 0.5 - frame) / inner.height - 1});
      const Face g = face_of(beyond);
      const auto [u, v] = texel_of(images[g], project(beyond, g));
      store(samplers[g].sample(u, v, 0), outer, x, y);
    }
  return outer;
}

// Reads a colour for face coordinates.
using Lookup = std::function<Light(const FacePoint&)>;

class Painter {
public:
  Painter(const AtlasLayout& layout, std::uint32_t channels, Progress& progress)
      : layout_(layout), progress_(progress), image_{layout.width, layout.height, channels, {}} {
    image_.pixels.resize(std::size_t{image_.width} * image_.height * image_.channels);
  }

  // Each texel is the mean of taps x taps reads.
  void paint(Face f, std::uint32_t taps, const Lookup& lookup) {
    const std::uint32_t left = layout_.chart_x(f), top = layout_.chart_y(f), side = layout_.chart();
    for (std::uint32_t y = 0; y < side; ++y) {
      if (y % report_interval == 0) {
        progress_.check();
        progress_.report(Stage::bake, std::uint64_t{f} * side + y, face_count * side);
      }
      for (std::uint32_t x = 0; x < side; ++x) {
        Light sum{};
        for (std::uint32_t j = 0; j < taps; ++j)
          for (std::uint32_t i = 0; i < taps; ++i) {
            const Light light = lookup(layout_.face_point(f, left + x + (i + 0.5) / taps, top + y + (j + 0.5) / taps));
            for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
          }
        for (float& c : sum) c /= static_cast<float>(taps * taps);
        store(sum, image_, left + x, top + y);
      }
    }
  }

  Image finish() {
    fill_gutters(layout_, image_);
    progress_.report(Stage::bake, face_count * layout_.chart(), face_count * layout_.chart());
    return std::move(image_);
  }

private:
  const AtlasLayout& layout_;
  Progress& progress_;
  Image image_;
};

void paint_faces(const AtlasLayout& layout, std::span<const Image> images, Painter& painter) {
  for (Face f = 0; f < face_count; ++f) {
    const double finest = std::max(images[f].width, images[f].height);
    const Footprint footprint = footprint_of(finest / layout.chart());
    const std::uint32_t frame = 2U << footprint.level; // two texels of the level that is read
    const Image source = framed(images, f, frame);
    const Sampler sampler(source, Wrap::clamp, Wrap::clamp, footprint.level + 1);
    painter.paint(f, footprint.taps, [&](const FacePoint& p) {
      const auto [x, y] = texel_of(images[f], p);
      return sampler.sample(x + frame, y + frame, footprint.level);
    });
  }
}

void paint_globe(const AtlasLayout& layout, const Image& image, Painter& painter) {
  // Four charts go around the equator, two from pole to pole. A chart's texel is largest on the sphere in the middle of
  // the chart: 4 / pi times the mean.
  const double quarter = std::max(image.width / 4.0, image.height / 2.0);
  const Footprint footprint = footprint_of(4 / std::numbers::pi * quarter / layout.chart());
  const Sampler sampler(image, Wrap::repeat, Wrap::clamp, footprint.level + 1);
  for (Face f = 0; f < face_count; ++f)
    painter.paint(f, footprint.taps, [&](const FacePoint& p) {
      const Vec3d d = direction(f, p);
      const double longitude = std::atan2(d.x, d.z), latitude = std::atan2(d.y, std::hypot(d.x, d.z));
      return sampler.sample((0.5 + longitude / (2 * std::numbers::pi)) * image.width,
                            (0.5 - latitude / std::numbers::pi) * image.height, footprint.level);
    });
}

} // namespace

Image bake_cube_map(const AtlasLayout& layout, std::span<const Image> images, Progress& progress) {
  if (images.size() != 1 && images.size() != face_count)
    throw Error(ErrorCode::invalid_option,
                "a cube map is six images (px, nx, py, ny, pz, nz) or one equirectangular image", "texture");
  if (std::any_of(images.begin(), images.end(), [](const Image& i) { return i.width == 0 || i.height == 0; }))
    throw Error(ErrorCode::invalid_option, "an image of the cube map has no pixels", "texture");
  const bool alpha = std::any_of(images.begin(), images.end(), [](const Image& i) { return i.channels == 4; });
  Painter painter(layout, alpha ? 4 : 3, progress);
  if (images.size() == 1)
    paint_globe(layout, images[0], painter);
  else
    paint_faces(layout, images, painter);
  return painter.finish();
}

} // namespace orbis::texture
