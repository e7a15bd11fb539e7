// Images of one colour.
#pragma once

#include "core/asset/image_codec.h"
#include "support/gltf_builder.h"

namespace orbis::test {

inline Bytes flat_png(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return asset::encode_png(texture::Image{2, 2, 3, {r, g, b, r, g, b, r, g, b, r, g, b}});
}

} // namespace orbis::test
