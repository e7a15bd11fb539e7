// Material libraries of OBJ files (MTL), material by material.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/asset/asset.h"
#include "core/asset/json.h"

namespace orbis::asset {

struct MtlMaterial {
  std::string name; // as it came, in whatever encoding
  // A glTF material. Its textures have a "file" in place of an index, and "clamp" where they do not repeat.
  Json gltf;
  std::vector<Asset::Note> notes; // what has no place in it
};

// Of the textures' options, -o and -s become KHR_texture_transform, -bm of a normal map its scale.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(std::span<const std::byte> library);

} // namespace orbis::asset
