#include "core/steps/encode_map.h"

#include "core/asset/image_codec.h"

namespace orbis {
namespace {

texture::Encoding encoding_of(MapKind kind) {
  return kind == MapKind::color ? texture::Encoding::srgb : texture::Encoding::linear;
}

} // namespace

asset::NewImage encode_map(const texture::Image& image, MapKind kind, const std::string& name, const Options& options) {
  const int quality = static_cast<int>(options.jpeg_quality);
  const bool lossy = kind != MapKind::directions;
  if (options.texture_format == TextureFormat::jpeg && lossy && image.channels == 3) {
    return {asset::encode_jpeg(image, quality), "image/jpeg", name};
  }
  if (options.texture_format == TextureFormat::webp) {
    const std::optional<int> lossy_quality = kind == MapKind::color ? std::optional(quality) : std::nullopt;
    return {asset::encode_webp(image, lossy_quality, options.threads), "image/webp", name};
  }
  return {asset::encode_png(image, encoding_of(kind), options.threads), "image/png", name};
}

asset::NewImage encode_map(const texture::Image16& image, MapKind kind, const std::string& name,
                           const Options& options) {
  return {asset::encode_png(image, encoding_of(kind), options.threads), "image/png", name};
}

std::string ending_of(const asset::NewImage& image) { return image.mime_type.substr(image.mime_type.find('/') + 1); }

} // namespace orbis
