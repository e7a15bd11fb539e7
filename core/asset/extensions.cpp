#include "core/asset/extensions.h"

#include <algorithm>
#include <span>

namespace orbis::asset {
namespace {

// A name that ends in '_' stands for all that begin with it.
using Names = std::span<const std::string_view>;

bool matches(std::string_view extension, Names names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
    return name.back() == '_' ? extension.substr(0, name.size()) == name : extension == name;
  });
}

constexpr std::string_view without_geometry[]{"KHR_materials_",    "EXT_materials_",
                                              "KHR_texture_",      "EXT_texture_",
                                              "MSFT_texture_dds",  "KHR_lights_",
                                              "EXT_lights_",       "EXT_mesh_gpu_instancing",
                                              "KHR_node_",         "KHR_animation_pointer",
                                              "KHR_xmp",           "KHR_xmp_json_ld",
                                              "KHR_interactivity", "EXT_structural_metadata",
                                              "EXT_mesh_features", "EXT_instance_features",
                                              "EXT_mesh_manifold", "CESIUM_primitive_outline",
                                              lod_extension};

constexpr std::string_view decoded[]{"KHR_draco_mesh_compression", "KHR_mesh_quantization", "EXT_meshopt_compression",
                                     "KHR_meshopt_compression"};

constexpr std::string_view with_known_references[]{
    "KHR_materials_",          "KHR_texture_",      "EXT_texture_webp",         "EXT_texture_avif", "MSFT_texture_dds",
    "KHR_lights_punctual",     "KHR_node_",         "KHR_animation_pointer",    "KHR_xmp",          "KHR_xmp_json_ld",
    "EXT_mesh_gpu_instancing", "EXT_mesh_manifold", "CESIUM_primitive_outline", lod_extension};

// The nesting is bounded by Limits::max_json_depth. Extras are the application's own.
void collect(const Json& value, std::set<std::string>& names) {
  if (value.is_array()) {
    for (const Json& item : value) collect(item, names);
  } else if (value.is_object()) {
    for (const auto& [key, item] : value.get_ref<const Json::object_t&>()) {
      if (key == "extras") continue;
      if (key == "extensions" && item.is_object()) {
        for (const auto& [name, object] : item.get_ref<const Json::object_t&>()) names.insert(name);
      }
      collect(item, names);
    }
  }
}

} // namespace

bool can_be_required(std::string_view extension) {
  return matches(extension, decoded) || matches(extension, without_geometry);
}

bool references_are_known(std::string_view extension) {
  return matches(extension, decoded) || matches(extension, with_known_references);
}

std::set<std::string> extension_objects(const Json& document) {
  std::set<std::string> names;
  collect(document, names);
  return names;
}

} // namespace orbis::asset
