#include "core/asset/obj_materials.h"

#include <algorithm>

#include "core/asset/extensions.h"
#include "core/asset/mtl_reader.h"
#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

// Windows' separators, which a URI would not have.
std::string with_slashes(std::string_view name) {
  std::string out(name);
  std::ranges::replace(out, '\\', '/');
  return out;
}

} // namespace

void ObjMaterials::read_libraries(std::string_view names) {
  if (names.find(' ') == std::string_view::npos || files_.has(with_slashes(names))) return read_library(names);
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(' '), names.size());
    if (end > 0) read_library(names.substr(0, end));
    names.remove_prefix(std::min(names.size(), end + 1));
  }
}

void ObjMaterials::read_library(std::string_view name) {
  const Bytes* file = files_.find(with_slashes(name), "");
  if (file == nullptr) {
    notes_.push_back(
        {"materials-missing",
         "the material library '" + shown(name) + "' did not come with the request; the model has no materials", ""});
    return;
  }
  for (MtlMaterial& material : read_mtl(*file)) {
    if (!read_.try_emplace(material.name, std::move(material.gltf)).second) continue;
    notes_.insert(notes_.end(), material.notes.begin(), material.notes.end());
  }
}

std::optional<std::size_t> ObjMaterials::texture(const std::string& name, bool repeats) {
  const auto [place, is_new] = textures_.try_emplace({name, repeats});
  if (is_new) place->second = add_texture_file(model_, files_, with_slashes(name), notes_, repeats);
  return place->second;
}

std::optional<Json> ObjMaterials::with_index(const Json& info) {
  const auto number = texture(info["file"].get<std::string>(), !info.contains("clamp"));
  if (!number) return std::nullopt;
  Json out{{"index", *number}};
  for (const auto& [key, value] : info.items()) {
    if (key != "file" && key != "clamp") out[key] = value;
  }
  if (find_path(out, "extensions", transform_extension)) model_.use_extension(transform_extension);
  return out;
}

std::optional<std::size_t> ObjMaterials::find(std::string_view name) {
  if (const auto known = numbers_.find(name); known != numbers_.end()) return known->second;
  std::optional<std::size_t>& number = numbers_[std::string(name)];
  const auto found = read_.find(name);
  if (found == read_.end()) {
    if (!read_.empty()) {
      notes_.push_back({"material-missing", "no material library has the material '" + shown(name) + "'", ""});
    }
    return number;
  }
  Json material = found->second;
  for (Json* owner : {&material["pbrMetallicRoughness"], &material}) {
    for (const auto* key : {"baseColorTexture", "normalTexture", "emissiveTexture"}) {
      const Json* info = asset::find(*owner, key);
      if (info == nullptr) continue;
      if (auto indexed = with_index(*info)) {
        (*owner)[key] = std::move(*indexed);
      } else {
        owner->erase(key);
      }
    }
  }
  return number = model_.add_material(std::move(material));
}

} // namespace orbis::asset
