// WebP through libwebp.
#include <webp/decode.h>

#include <limits>

#include "core/asset/image_formats.h"

namespace orbis::asset {

texture::Image decode_webp(const ImageRequest& request) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(request.bytes.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, request.bytes.size(), &features) != VP8_STATUS_OK || features.width <= 0 ||
      features.height <= 0)
    request.refuse("is damaged: its WebP header cannot be read");
  if (features.has_animation != 0) request.refuse("is an animation: send a still image");
  texture::Image image{static_cast<std::uint32_t>(features.width),
                       static_cast<std::uint32_t>(features.height),
                       features.has_alpha != 0 ? 4U : 3U,
                       {}};
  request.check_size(image.width, image.height);
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  const int stride = static_cast<int>(image.width * image.channels); // at most 4 * 16383
  const auto* decoded =
      features.has_alpha != 0
          ? WebPDecodeRGBAInto(data, request.bytes.size(), image.pixels.data(), image.pixels.size(), stride)
          : WebPDecodeRGBInto(data, request.bytes.size(), image.pixels.data(), image.pixels.size(), stride);
  if (decoded == nullptr) request.refuse("is damaged: its WebP data cannot be decoded");
  return image;
}

} // namespace orbis::asset
