// sRGB bytes and linear light (IEC 61966-2-1), by table.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace orbis::texture {

struct SrgbTables {
  // sRGB is steepest at black: 12.92 * 255 = 3295 bytes per unit of light, about 20 steps of the table to a byte. An
  // entry is the byte of the middle of its step, so that a lookup need not round.
  static constexpr std::size_t steps = 1U << 16U;
  std::array<float, 256> linear{};
  std::array<float, 256> fraction{}; // i / 255
  std::array<std::uint8_t, steps> srgb{};

  SrgbTables();
};
extern const SrgbTables srgb_tables;

// [0, 1]; exact to float precision.
[[nodiscard]] inline float to_linear(std::uint8_t srgb) { return srgb_tables.linear[srgb]; }

// The nearest byte; values outside [0, 1] are clamped, NaN gives 0. to_srgb(to_linear(b)) == b.
[[nodiscard]] inline std::uint8_t to_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  return srgb_tables.srgb[static_cast<std::size_t>(linear * static_cast<float>(SrgbTables::steps))];
}

// The nearest byte of what is linear already, as alpha.
[[nodiscard]] inline std::uint8_t to_byte(float value) {
  if (!(value > 0)) return 0;
  return value >= 1 ? 255 : static_cast<std::uint8_t>(std::lround(255 * value));
}

// How an image's bytes mean numbers: colours as sRGB, data (roughness, normals, …) as fractions of 255. Alpha is linear
// in both.
enum class Encoding : std::uint8_t { srgb, linear };

using Rgb = std::array<std::uint8_t, 3>;
// a where t = 0, b where t = 1, mixed in linear light.
[[nodiscard]] Rgb mixed(const Rgb& a, const Rgb& b, float t);

} // namespace orbis::texture
