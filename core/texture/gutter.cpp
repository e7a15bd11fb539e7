#include <algorithm>

#include "core/texture/bake.h"
#include "core/texture/sampler.h"

namespace orbis::texture {
namespace {

// Bilinear in linear light, from texels of one chart only.
Light sample_chart(const AtlasLayout& layout, const Image& image, Face f, double x, double y) {
  const std::uint32_t left = layout.chart_x(f), top = layout.chart_y(f), last = layout.chart() - 1;
  const double column = std::clamp(x - left - 0.5, 0.0, static_cast<double>(last));
  const double row = std::clamp(y - top - 0.5, 0.0, static_cast<double>(last));
  const auto c0 = static_cast<std::uint32_t>(column), r0 = static_cast<std::uint32_t>(row);
  const std::uint32_t c1 = std::min(c0 + 1, last), r1 = std::min(r0 + 1, last);
  const auto s = static_cast<float>(column - c0), t = static_cast<float>(row - r0);
  const Light a = load(image, left + c0, top + r0), b = load(image, left + c1, top + r0);
  const Light c = load(image, left + c0, top + r1), d = load(image, left + c1, top + r1);
  Light result{};
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = (1 - t) * ((1 - s) * a[k] + s * b[k]) + t * ((1 - s) * c[k] + s * d[k]);
  return result;
}

} // namespace

void fill_gutters(const AtlasLayout& layout, Image& image) {
  for (std::uint32_t y = 0; y < layout.height; ++y)
    for (std::uint32_t x = 0; x < layout.width; ++x) {
      const Face f = layout.face_at(x, y);
      if (layout.in_chart(x, y)) {
        x = layout.chart_x(f) + layout.chart() - 1;
        continue;
      }
      const Vec3d beyond = direction(f, layout.face_point(f, x + 0.5, y + 0.5));
      const Face g = face_of(beyond);
      const auto [from_x, from_y] = layout.texel_of(g, project(beyond, g));
      store(sample_chart(layout, image, g, from_x, from_y), image, x, y);
    }
}

} // namespace orbis::texture
