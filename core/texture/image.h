// Images in memory: rows from top to bottom, channels interleaved, 8 or 16 bits each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace orbis::texture {

struct Image {
  std::uint32_t width = 0, height = 0;
  std::uint32_t channels = 4;       // 3: RGB, 4: RGBA (straight alpha)
  std::vector<std::uint8_t> pixels; // width * height * channels

  [[nodiscard]] const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const {
    return pixels.data() + (std::size_t{y} * width + x) * channels;
  }
  [[nodiscard]] std::uint8_t* at(std::uint32_t x, std::uint32_t y) {
    return pixels.data() + (std::size_t{y} * width + x) * channels;
  }
};

struct Image16 {
  std::uint32_t width = 0, height = 0;
  std::uint32_t channels = 3;        // 1: grey, 3: RGB
  std::vector<std::uint16_t> pixels; // width * height * channels

  [[nodiscard]] const std::uint16_t* at(std::uint32_t x, std::uint32_t y) const {
    return pixels.data() + (std::size_t{y} * width + x) * channels;
  }
  [[nodiscard]] std::uint16_t* at(std::uint32_t x, std::uint32_t y) {
    return pixels.data() + (std::size_t{y} * width + x) * channels;
  }
};

} // namespace orbis::texture
