// Materials: where they keep their base colour, and how the atlas takes its place.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/asset/json.h"

namespace orbis::asset {

// The texture info of the base colour: pbrMetallicRoughness.baseColorTexture, or the diffuse texture of the older
// KHR_materials_pbrSpecularGlossiness. Null where there is none.
[[nodiscard]] const Json* base_color_texture(const Json& material);

// A primitive of the document that shows a page of the atlas, sampled by TEXCOORD_texcoord.
struct AtlasUser {
  std::size_t mesh = 0, primitive = 0; // /meshes/mesh/primitives/primitive
  std::uint32_t texcoord = 0;
  std::size_t texture = 0; // of the document: the page
};

// Gives every user a material whose base colour is its texture: its own, changed in place, where nothing else uses that
// one, else a copy; a new one (named after the mesh, dielectric, roughness 0.8) where it has none. Other textures stay
// as they are. The mappings of KHR_materials_variants follow where they name the primitive's own material.
void assign_atlas(Json& document, const std::vector<AtlasUser>& users);

} // namespace orbis::asset
