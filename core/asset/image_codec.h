// PNG, JPEG and WebP through libpng, libjpeg-turbo and libwebp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/texture/image.h"

namespace orbis::asset {

// Decodes PNG, JPEG or WebP, recognised by content, to RGB or RGBA, 8 bits. The header is checked against `max_pixels`
// before anything is allocated. `where` goes into errors. Throws Error: malformed, unsupported_format, too_large.
[[nodiscard]] texture::Image decode_image(std::span<const std::byte> bytes, std::uint64_t max_pixels,
                                          std::string_view where);

// Deterministic: same image, same bytes. PNG keeps alpha, JPEG drops it (quality 1 to 100, 4:4:4 so that charts do not
// bleed).
[[nodiscard]] std::vector<std::byte> encode_png(const texture::Image& image);
[[nodiscard]] std::vector<std::byte> encode_jpeg(const texture::Image& image, int quality);

} // namespace orbis::asset
