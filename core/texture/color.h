// sRGB bytes and linear light (IEC 61966-2-1), by table.
#pragma once

#include <array>
#include <cstdint>

namespace orbis::texture {

// [0, 1]; exact to float precision.
[[nodiscard]] float to_linear(std::uint8_t srgb);
// The nearest byte; values outside [0, 1] are clamped, NaN gives 0. to_srgb(to_linear(b)) == b.
[[nodiscard]] std::uint8_t to_srgb(float linear);
// Alpha is linear already.
[[nodiscard]] std::uint8_t to_byte(float value);

using Rgb = std::array<std::uint8_t, 3>;
// a where t = 0, b where t = 1, mixed in linear light.
[[nodiscard]] Rgb mixed(const Rgb& a, const Rgb& b, float t);

} // namespace orbis::texture
