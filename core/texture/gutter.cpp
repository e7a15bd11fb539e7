#include <algorithm>
#include <cmath>

#include "core/texture/bake.h"
#include "core/texture/color.h"

namespace orbis::texture {
namespace {

// Bilinear in linear light, from texels of one chart only.
void sample_chart(const AtlasLayout& layout, const Image& image, Face f, double x, double y, std::uint8_t* out) {
  const double last = layout.chart() - 1.0;
  const double column = std::clamp(x - layout.chart_x(f) - 0.5, 0.0, last);
  const double row = std::clamp(y - layout.chart_y(f) - 0.5, 0.0, last);
  const auto c0 = static_cast<std::uint32_t>(column), r0 = static_cast<std::uint32_t>(row);
  const std::uint32_t c1 = std::min(c0 + 1, layout.chart() - 1), r1 = std::min(r0 + 1, layout.chart() - 1);
  const auto s = static_cast<float>(column - c0), t = static_cast<float>(row - r0);
  const std::uint32_t left = layout.chart_x(f), top = layout.chart_y(f);
  const std::array<const std::uint8_t*, 4> texels{image.at(left + c0, top + r0), image.at(left + c1, top + r0),
                                                  image.at(left + c0, top + r1), image.at(left + c1, top + r1)};
  const std::array<float, 4> weights{(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  std::array<float, 4> sum{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::uint32_t c = 0; c < image.channels; ++c)
      sum[c] += weights[i] * (c < 3 ? to_linear(texels[i][c]) : static_cast<float>(texels[i][c]) / 255);
  for (std::uint32_t c = 0; c < image.channels; ++c) out[c] = c < 3 ? to_srgb(sum[c]) : to_byte(sum[c]);
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
      sample_chart(layout, image, g, from_x, from_y, image.at(x, y));
    }
}

} // namespace orbis::texture
