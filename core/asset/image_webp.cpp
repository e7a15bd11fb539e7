// WebP through libwebp.
#include <webp/decode.h>
#include <webp/encode.h>

#include "core/asset/image_codec.h"

#include "core/asset/image_formats.h"
#include "core/error.h"

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

namespace {

// libwebp's structs, freed on every way out.
struct Encoder {
  WebPConfig config{};
  WebPPicture picture{};
  WebPMemoryWriter writer{};

  Encoder() {
    WebPMemoryWriterInit(&writer);
    if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0)
      throw Error(ErrorCode::internal, "libwebp has another version than its headers");
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
  }
};

} // namespace

std::vector<std::byte> encode_webp(const texture::Image& image, std::optional<int> quality, std::uint32_t threads) {
  Encoder encoder;
  WebPConfig& config = encoder.config;
  config.lossless = quality ? 0 : 1;
  config.quality = quality ? static_cast<float>(*quality) : 20; // without loss: the effort
  config.method = quality ? 3 : 0;                              // 0 (fast) to 6
  config.exact = 1;                                             // colour counts under transparent texels too
  config.use_sharp_yuv = 1;                                     // charts are small: chroma must not bleed
  config.thread_level = threads == 1 ? 0 : 1;                   // does not change the result
  WebPPicture& picture = encoder.picture;
  picture.use_argb = 1; // lossy too: the encoder then converts to YUV itself, sharply
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  const int stride = static_cast<int>(image.width * image.channels);
  const int imported = image.channels == 4 ? WebPPictureImportRGBA(&picture, image.pixels.data(), stride)
                                           : WebPPictureImportRGB(&picture, image.pixels.data(), stride);
  if (imported == 0 || WebPEncode(&config, &picture) == 0)
    throw Error(ErrorCode::internal, "an image could not be encoded as WebP");
  const auto* first = reinterpret_cast<const std::byte*>(encoder.writer.mem);
  return {first, first + encoder.writer.size};
}

} // namespace orbis::asset
