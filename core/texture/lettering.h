// A small built-in stroke font: crisp at any size, no font file needed.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace orbis::texture {

// How much of each texel a text covers, 0 to 255; rows from top to bottom.
struct TextMask {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> coverage;
};

// text: of the characters + - A to H, X Y Z and 1 to 8; others leave a space. height: of the capitals in texels; the
// mask has a margin of half a stroke around them.
[[nodiscard]] TextMask draw_text(std::string_view text, double height);

} // namespace orbis::texture
