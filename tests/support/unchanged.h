// Assets written as if their surface had been parametrized without a cut.
#pragma once

#include <string>
#include <vector>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

namespace orbis::test {

// Every vertex stays, with coordinates of the atlas beside it, all of them 0.
inline std::vector<asset::NewPrimitive> unchanged(const asset::Asset& asset) {
  std::vector<asset::NewPrimitive> out;
  for (const asset::Primitive& p : asset.primitives) {
    asset::NewPrimitive primitive;
    primitive.indices = p.indices;
    primitive.attributes = p.attributes;
    primitive.targets = p.targets;
    primitive.textures[asset::TextureSlot::base_color] = 0;
    while (p.find("TEXCOORD_" + std::to_string(primitive.atlas_texcoord))) ++primitive.atlas_texcoord;
    const std::string name = "TEXCOORD_" + std::to_string(primitive.atlas_texcoord);
    primitive.attributes.push_back({name, asset::ComponentType::f32, false, 2, Bytes(p.vertex_count() * 8)});
    out.push_back(std::move(primitive));
  }
  return out;
}

inline Bytes write_unchanged(const asset::Asset& asset, Compression compression = Compression::none) {
  const std::vector<asset::NewImage> images{{tiny_png(), "image/png"}};
  return asset::write_asset(asset, unchanged(asset), images, "{}", compression);
}

} // namespace orbis::test
