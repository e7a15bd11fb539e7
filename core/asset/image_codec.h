// PNG, JPEG and WebP through libpng, libjpeg-turbo and libwebp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/texture/color.h"
#include "core/texture/image.h"

namespace orbis::asset {

// Decodes PNG, JPEG or WebP, recognised by content, to RGB or RGBA, 8 bits. The header is checked against `max_pixels`
// before anything is allocated. `where` goes into errors. Throws Error: malformed, unsupported_format, too_large.
[[nodiscard]] texture::Image decode_image(std::span<const std::byte> bytes, std::uint64_t max_pixels,
                                          std::string_view where);

// Deterministic: same image, same bytes, on any number of threads (0: as many as the machine has).
//
// PNG keeps alpha and 16 bits. JPEG drops alpha (quality 1 to 100, 4:4:4 so that charts do not bleed). WebP keeps
// alpha; it is lossy with the given quality, or lossless where that is absent, and takes up to 16383 texels a side.
[[nodiscard]] std::vector<std::byte> encode_png(const texture::Image& image,
                                                texture::Encoding encoding = texture::Encoding::srgb,
                                                std::uint32_t threads = 1);
[[nodiscard]] std::vector<std::byte> encode_png(const texture::Image16& image, texture::Encoding encoding,
                                                std::uint32_t threads = 1);
[[nodiscard]] std::vector<std::byte> encode_jpeg(const texture::Image& image, int quality);
[[nodiscard]] std::vector<std::byte> encode_webp(const texture::Image& image, std::optional<int> quality,
                                                 std::uint32_t threads = 1);

} // namespace orbis::asset
