// Materials: where they keep their textures, and how the atlas takes their place.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/asset/animated_property.h"
#include "core/asset/asset.h"
#include "core/asset/json.h"
#include "core/texture/alpha.h"

namespace orbis::asset {

// The texture info of a slot; for base_color also the diffuse texture of the older KHR_materials_pbrSpecularGlossiness.
// Null where there is none.
[[nodiscard]] const Json* texture_info(const Json& material, TextureSlot slot);

// The primitive's material, or null where it has none.
[[nodiscard]] const Json* material_of(const Asset& asset, const Primitive& primitive);

// The base colour factor of a primitive's material, linear RGB and alpha; 1 without one.
[[nodiscard]] std::array<float, 4> base_color_factor(const Asset& asset, const Primitive& primitive);

// What the alpha of its base colour means.
[[nodiscard]] texture::Alpha alpha_of(const Asset& asset, const Primitive& primitive);

// Whether its back faces are drawn, as glTF says it.
[[nodiscard]] bool is_double_sided(const Asset& asset, const Primitive& primitive);

// Whether its back faces are a part of what is seen: those of double-sided materials, and all that came in a format
// other than glTF. These do not tell sides apart, and scans in them are often open.
[[nodiscard]] bool shows_back_faces(const Asset& asset, const Primitive& primitive);

// What becomes of a material on the atlas.
struct AtlasLook {
  std::uint32_t texcoord = 0;                  // TEXCOORD_texcoord samples the new textures
  std::map<TextureSlot, std::size_t> textures; // slot -> texture of the document
  bool plain_base_color = false;               // the base colour factor goes

  friend auto operator<=>(const AtlasLook&, const AtlasLook&) = default;
};

// A primitive of the document that shows the atlas.
struct AtlasUser {
  std::size_t mesh = 0, primitive = 0; // /meshes/mesh/primitives/primitive
  AtlasLook look;
};

// Gives every user a material with its look: its own, changed in place, where nothing else uses that one otherwise,
// else a copy; a new one (named after the mesh, dielectric, roughness 0.8) where it has none. Other textures stay as
// they are. A normal map that is replaced has scale 1. The mappings of KHR_materials_variants follow where they name
// the primitive's own material. Returns the copies.
std::vector<PartCopy> assign_atlas(Json& document, const std::vector<AtlasUser>& users);

// The primitives of levels of detail share their materials with the full surface, but for textures of their own.
class LevelMaterials {
public:
  explicit LevelMaterials(Json& document) : document_(document) {}

  // Gives a primitive, which has a material of the full surface's, a copy of it with these textures; the same copy for
  // the same material and look. The materials of its variants get the normal map.
  void assign(Json& primitive, const AtlasLook& look);

  // All that were made so far.
  [[nodiscard]] std::span<const PartCopy> copies() const { return made_; }

private:
  [[nodiscard]] std::size_t copy_of(std::size_t material, const AtlasLook& look);

  Json& document_;
  std::map<std::pair<std::size_t, AtlasLook>, std::size_t> copies_;
  std::vector<PartCopy> made_;
};

} // namespace orbis::asset
