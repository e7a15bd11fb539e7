#include "core/asset/image_codec.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/asset/image_formats.h"
#include "core/error.h"

namespace orbis::asset {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::size_t offset, std::string_view magic) {
  if (bytes.size() < offset + magic.size()) return false;
  return std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                    [](char c, std::byte b) { return static_cast<std::byte>(c) == b; });
}

} // namespace

texture::Image decode_image(std::span<const std::byte> bytes, std::uint64_t max_pixels, std::string_view where) {
  const ImageRequest request{bytes, max_pixels, where};
  if (starts_with(bytes, 0, "\x89PNG\r\n\x1a\n")) return decode_png(request);
  if (starts_with(bytes, 0, "\xff\xd8\xff")) return decode_jpeg(request);
  if (starts_with(bytes, 0, "RIFF") && starts_with(bytes, 8, "WEBP")) return decode_webp(request);
  throw Error(ErrorCode::unsupported_format, "the image is neither PNG, JPEG nor WebP", std::string(where));
}

void ImageRequest::check_size(std::uint64_t width, std::uint64_t height) const {
  if (width == 0 || height == 0) refuse("has no pixels");
  if (width > max_pixels / height)
    throw Error(ErrorCode::too_large,
                "the image has " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels, more than the limit of " + std::to_string(max_pixels),
                std::string(where));
}

void ImageRequest::refuse(std::string_view fault) const {
  throw Error(ErrorCode::malformed, "the image " + std::string(fault), std::string(where));
}

} // namespace orbis::asset
