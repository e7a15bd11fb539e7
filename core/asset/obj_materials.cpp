#include "core/asset/obj_materials.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

using Material = tinyobj::material_t;

// Blinn's specular exponent as glTF's roughness: alpha = roughness^2 and alpha^2 = 2 / (exponent + 2)
// (B. Walter et al., Microfacet Models for Refraction through Rough Surfaces, 2007, section 5.2).
double roughness_of(double exponent) { return std::pow(2 / (std::max(exponent, 0.0) + 2), 0.25); }

double unit(double value) { return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 1.0; }

Json color(const tinyobj::real_t (&rgb)[3]) {
  return Json::array({unit(double{rgb[0]}), unit(double{rgb[1]}), unit(double{rgb[2]})});
}

// In place of a texture's number: the file's name.
Json named_texture(const std::string& file) { return Json{{"file", file}}; }

// Diffuse colour and map become the base colour. Where there is a map it is the whole colour: most programs write a
// grey of no meaning beside it.
Json base_color(const Material& material) {
  Json pbr = Json::object();
  if (material.diffuse_texname.empty()) {
    pbr["baseColorFactor"] = color(material.diffuse);
    pbr["baseColorFactor"].push_back(unit(double{material.dissolve}));
  } else {
    if (material.dissolve < 1) pbr["baseColorFactor"] = {1, 1, 1, unit(double{material.dissolve})};
    pbr["baseColorTexture"] = named_texture(material.diffuse_texname);
  }
  const bool has_roughness = material.roughness > 0 || material.metallic > 0;
  pbr["metallicFactor"] = unit(double{material.metallic});
  pbr["roughnessFactor"] =
      has_roughness ? unit(double{material.roughness}) : unit(roughness_of(double{material.shininess}));
  return pbr;
}

Json gltf_material(const Material& material) {
  Json out{{"name", material.name}, {"pbrMetallicRoughness", base_color(material)}};
  if (!material.normal_texname.empty()) out["normalTexture"] = named_texture(material.normal_texname);
  if (!material.emissive_texname.empty()) {
    out["emissiveTexture"] = named_texture(material.emissive_texname);
    out["emissiveFactor"] = {1, 1, 1};
  } else if (material.emission[0] > 0 || material.emission[1] > 0 || material.emission[2] > 0) {
    out["emissiveFactor"] = color(material.emission);
  }
  // An opacity map of its own has no place in glTF; most often it is the alpha of the diffuse map.
  const bool cuts_out = !material.alpha_texname.empty() && material.alpha_texname == material.diffuse_texname;
  if (material.dissolve < 1 || cuts_out) out["alphaMode"] = "BLEND";
  return out;
}

void note_lost_maps(const Material& material, std::vector<Asset::Note>& notes) {
  const std::pair<const char*, const std::string*> maps[]{
      {"bump", &material.bump_texname},         {"displacement", &material.displacement_texname},
      {"specular", &material.specular_texname}, {"roughness", &material.roughness_texname},
      {"metallic", &material.metallic_texname}, {"reflection", &material.reflection_texname}};
  for (const auto& [kind, file] : maps) {
    if (file->empty()) continue;
    notes.push_back({"map-not-carried-over",
                     "the " + std::string(kind) + " map '" + shown(*file) + "' of the material '" +
                         shown(material.name) + "' has no place of its own in glTF and is not carried over",
                     ""});
  }
}

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
  std::istringstream text(std::string(reinterpret_cast<const char*>(file->data()), file->size()));
  std::map<std::string, int> numbers;
  std::vector<Material> materials;
  std::string warning, error;
  tinyobj::LoadMtl(&numbers, &materials, &text, &warning, &error);
  for (const Material& material : materials) {
    if (!read_.try_emplace(material.name, gltf_material(material)).second) continue;
    note_lost_maps(material, notes_);
  }
}

std::optional<std::size_t> ObjMaterials::texture(const std::string& name) {
  const auto [place, is_new] = textures_.try_emplace(name);
  if (is_new) place->second = add_texture_file(model_, files_, with_slashes(name), notes_);
  return place->second;
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
      const Json* file = find_path(*owner, key, "file");
      if (file == nullptr) continue;
      const auto image = texture(file->get<std::string>());
      if (image) {
        (*owner)[key] = Json{{"index", *image}};
      } else {
        owner->erase(key);
      }
    }
  }
  return number = model_.add_material(std::move(material));
}

} // namespace orbis::asset
