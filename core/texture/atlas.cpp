#include "core/texture/atlas.h"

#include <algorithm>
#include <bit>

#include "core/error.h"

namespace orbis::texture {

AtlasLayout layout_for(std::uint32_t texture_size) {
  if (texture_size < 64 || texture_size > 8192)
    throw Error(ErrorCode::invalid_option, "the atlas must be 64 to 8192 texels wide", "texture_size");
  AtlasLayout layout;
  layout.width = texture_size;
  layout.cell = texture_size / 3;
  layout.height = (2 * layout.cell + 3) / 4 * 4;
  layout.gutter = std::bit_floor(std::max(layout.cell / 40, 2U));
  return layout;
}

Face AtlasLayout::face_at(std::uint32_t x, std::uint32_t y) const {
  return static_cast<Face>(3 * std::min(y / cell, 1U) + std::min(x / cell, 2U));
}

bool AtlasLayout::in_chart(std::uint32_t x, std::uint32_t y) const {
  const Face f = face_at(x, y);
  // Left of the chart the unsigned difference wraps around to a large number.
  return x - chart_x(f) < chart() && y - chart_y(f) < chart();
}

double AtlasLayout::utilisation() const {
  const double side = chart();
  return static_cast<double>(face_count) * side * side / (static_cast<double>(width) * height);
}

std::array<double, 2> AtlasLayout::texel_of(Face f, const FacePoint& p) const {
  const double half = 0.5 * chart();
  return {chart_x(f) + half * (p.u + 1), chart_y(f) + half * (p.v + 1)};
}

FacePoint AtlasLayout::face_point(Face f, double texel_x, double texel_y) const {
  const double scale = 2.0 / chart();
  return {scale * (texel_x - chart_x(f)) - 1, scale * (texel_y - chart_y(f)) - 1};
}

} // namespace orbis::texture
