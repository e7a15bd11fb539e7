// What is known about glTF extensions: which ones concern the decoding of geometry, and where they keep references.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "core/asset/json.h"

namespace orbis::asset {

inline constexpr std::string_view draco_extension = "KHR_draco_mesh_compression";
inline constexpr std::string_view quantization_extension = "KHR_mesh_quantization";
inline constexpr std::string_view transform_extension = "KHR_texture_transform";
inline constexpr std::string_view lod_extension = "MSFT_lod";
inline constexpr std::string_view meshopt_extensions[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

// True where a document that requires the extension can still be read: orbis decodes it, or it changes nothing about
// how geometry is stored (materials, textures, lights, instancing, animation, metadata).
[[nodiscard]] bool can_be_required(std::string_view extension);

// True where every accessor, buffer view and image that the extension refers to is known (references.h). A document
// that uses another one keeps all of its accessors, buffer views and images under their numbers.
[[nodiscard]] bool references_are_known(std::string_view extension);

// The extensions whose objects occur in the document.
[[nodiscard]] std::set<std::string> extension_objects(const Json& document);

} // namespace orbis::asset
