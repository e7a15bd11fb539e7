#include "core/texture/color.h"

#include <cmath>

namespace orbis::texture {

const SrgbTables srgb_tables;

SrgbTables::SrgbTables() {
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const double c = static_cast<double>(i) / 255;
    fraction[i] = static_cast<float>(c);
    linear[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  for (std::size_t i = 0; i < steps; ++i) {
    const double light = (static_cast<double>(i) + 0.5) / steps;
    const double c = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    srgb[i] = static_cast<std::uint8_t>(std::lround(255 * c));
  }
}

Rgb mixed(const Rgb& a, const Rgb& b, float t) {
  Rgb result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = to_srgb((1 - t) * to_linear(a[c]) + t * to_linear(b[c]));
  return result;
}

} // namespace orbis::texture
