// Vertex colours as glTF stores them: linear. Other formats hold them as they are shown.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/asset/asset.h"

namespace orbis::asset {

// IEC 61966-2-1, from [0, 1] to [0, 1]; what lies outside is clamped.
[[nodiscard]] inline double linear_from_srgb(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// An empty COLOR_0: 8 bits of sRGB need 16 when they are linear.
[[nodiscard]] inline Attribute linear_colors(std::size_t count, std::uint32_t components) {
  Attribute out{"COLOR_0", ComponentType::u16, true, components, {}};
  out.data.resize(count * components * size_of(out.type));
  return out;
}

} // namespace orbis::asset
