// How a baked map is stored.
#pragma once

#include <string>

#include "core/asset/asset.h"
#include "core/options.h"
#include "core/texture/color.h"
#include "core/texture/image.h"

namespace orbis {

enum class MapKind { color, data, directions };

// As options.texture_format asks for: colours and data as PNG, JPEG or WebP. Directions (normal maps) are stored
// without loss, and so is what has alpha where the format is JPEG, which has none: PNG, or lossless WebP. WebP is
// lossless for data too, since its lossy form halves the resolution of two of three channels.
[[nodiscard]] asset::NewImage encode_map(const texture::Image& image, MapKind kind, const std::string& name,
                                         const Options& options);
// 16 bits: always PNG.
[[nodiscard]] asset::NewImage encode_map(const texture::Image16& image, MapKind kind, const std::string& name,
                                         const Options& options);

// "image/png" -> "png"
[[nodiscard]] std::string ending_of(const asset::NewImage& image);

} // namespace orbis
