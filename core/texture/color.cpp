#include "core/texture/color.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace orbis::texture {
namespace {

// sRGB is steepest at black: 12.92 * 255 = 3295 bytes per unit of light, about 20 steps of this table to a byte.
constexpr std::size_t encode_steps = 1U << 16U;

struct Tables {
  std::array<float, 256> linear{};
  std::vector<std::uint8_t> srgb = std::vector<std::uint8_t>(encode_steps + 1);

  Tables() {
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      linear[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    for (std::size_t i = 0; i <= encode_steps; ++i) {
      const double light = static_cast<double>(i) / encode_steps;
      const double c = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
      srgb[i] = static_cast<std::uint8_t>(std::lround(255 * c));
    }
  }
};

const Tables& tables() {
  static const Tables instance;
  return instance;
}

} // namespace

float to_linear(std::uint8_t srgb) { return tables().linear[srgb]; }

std::uint8_t to_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  return tables().srgb[static_cast<std::size_t>(linear * static_cast<float>(encode_steps) + 0.5F)];
}

std::uint8_t to_byte(float value) {
  if (!(value > 0)) return 0;
  return value >= 1 ? 255 : static_cast<std::uint8_t>(value * 255 + 0.5F);
}

Rgb mixed(const Rgb& a, const Rgb& b, float t) {
  Rgb result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = to_srgb((1 - t) * to_linear(a[c]) + t * to_linear(b[c]));
  return result;
}

} // namespace orbis::texture
