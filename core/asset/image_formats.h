// One decoder a format, behind decode_image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/texture/image.h"

namespace orbis::asset {

// An image to decode, and what its decoders have in common.
struct ImageRequest {
  std::span<const std::byte> bytes;
  std::uint64_t max_pixels;
  std::string_view where;

  // Throws Error{malformed} for an empty image, Error{too_large} for one of more than max_pixels. To be called as soon
  // as the header is read.
  void check_size(std::uint64_t width, std::uint64_t height) const;
  // Throws Error{malformed}: "the image " + fault.
  [[noreturn]] void refuse(std::string_view fault) const;
};

// RGB or RGBA where the image has transparency, 8 bits a channel.
[[nodiscard]] texture::Image decode_png(const ImageRequest& request);
[[nodiscard]] texture::Image decode_jpeg(const ImageRequest& request);
[[nodiscard]] texture::Image decode_webp(const ImageRequest& request);

} // namespace orbis::asset
