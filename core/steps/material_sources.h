// Which textures of the input's materials are baked, and their images.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/asset/asset.h"
#include "core/options.h"
#include "core/report.h"
#include "core/steps/delivery.h"
#include "core/texture/image.h"
#include "core/texture/texture_reader.h"

namespace orbis {

// One slot of all primitives; nothing where a primitive's material has no such texture, or keeps it.
using SlotTextures = std::vector<std::optional<asset::MaterialTexture>>;

// The textures of a slot, of the primitives that have triangles in the result. Notes a texture that stays on its old
// coordinates because its image did not come or cannot be decoded.
[[nodiscard]] SlotTextures textures_of(const asset::Asset& asset, const Delivery& delivery, asset::TextureSlot slot,
                                       Report& report);

// Decoded images by their number in the document.
using DecodedImages = std::map<std::size_t, std::shared_ptr<const texture::Image>>;

// Decodes images page by page. Those that fit into `most_kept` bytes are there when the next page asks for them:
// hundreds of materials may share one.
class ImageDecoder {
public:
  // Keeps references to all three.
  ImageDecoder(const asset::Asset& asset, const Limits& limits, Report& report, std::size_t most_kept)
      : asset_(asset), limits_(limits), report_(report), most_kept_(most_kept) {}

  // What the textures name. A primitive whose image is in an unknown format loses its texture, with a note; so does
  // one whose image is damaged, unless that is an error (`strict`). Throws Error: malformed, too_large.
  [[nodiscard]] DecodedImages decode(bool strict, SlotTextures& textures);

private:
  std::shared_ptr<const texture::Image> image(const asset::MaterialTexture& texture, const std::string& where);

  const asset::Asset& asset_;
  const Limits& limits_;
  Report& report_;
  std::size_t most_kept_, kept_bytes_ = 0;
  DecodedImages kept_;
};

// How the textures are to be read, by primitive; without a texture: white. Refers to `images`.
[[nodiscard]] std::vector<texture::TextureSource> sources_of(const SlotTextures& textures, const DecodedImages& images);

// By primitive, whether COLOR_0 is baked into its base colour: it has one that is not white throughout, no morph target
// moves it, and no variant's material would miss it.
[[nodiscard]] std::vector<bool> bakes_vertex_colors(const asset::Asset& asset, const Delivery& delivery);

// "/meshes/1/primitives/0"
[[nodiscard]] std::string pointer_to(const asset::Primitive& p);

} // namespace orbis
