#include "core/asset/materials.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "core/asset/document.h"
#include "core/asset/extensions.h"

namespace orbis::asset {
namespace {

constexpr std::string_view specular_glossiness = "KHR_materials_pbrSpecularGlossiness";
constexpr std::size_t no_material = static_cast<std::size_t>(-1);

std::size_t material_of(const Json& primitive) {
  const Json* material = find(primitive, "material");
  return material ? material->get<std::size_t>() : no_material;
}

Json* variant_mappings(Json& primitive) {
  Json* found = find_path(primitive, "extensions", "KHR_materials_variants", "mappings");
  return found && found->is_array() ? found : nullptr;
}

void set_texture(Json& parent, std::string_view key, std::size_t texture, std::uint32_t texcoord) {
  Json& info = parent[std::string(key)];
  if (!info.is_object()) info = Json::object();
  info["index"] = texture;
  info.erase("texCoord");
  if (texcoord != 0) info["texCoord"] = texcoord;
  // The atlas has coordinates of its own.
  if (Json* extensions = find(info, "extensions"); extensions && extensions->is_object()) {
    extensions->erase(std::string(transform_extension));
    if (extensions->empty()) info.erase("extensions");
  }
}

// Whether the older model of a material has an image of its own, which the base colour was not baked from.
bool differs_in_diffuse(const Json& material) {
  const Json* base = find_path(material, "pbrMetallicRoughness", "baseColorTexture", "index");
  const Json* diffuse = find_path(material, "extensions", specular_glossiness, "diffuseTexture", "index");
  return base && diffuse && *base != *diffuse;
}

void set_slot(Json& material, TextureSlot slot, std::size_t texture, const AtlasLook& look) {
  const std::uint32_t texcoord = look.texcoord;
  switch (slot) {
  case TextureSlot::base_color:
    if (Json* older = find_path(material, "extensions", specular_glossiness);
        older && older->is_object() && (look.plain_base_color || !differs_in_diffuse(material))) {
      set_texture(*older, "diffuseTexture", texture, texcoord);
    }
    return set_texture(material["pbrMetallicRoughness"], "baseColorTexture", texture, texcoord);
  case TextureSlot::metallic_roughness:
    return set_texture(material["pbrMetallicRoughness"], "metallicRoughnessTexture", texture, texcoord);
  case TextureSlot::occlusion:
    return set_texture(material, "occlusionTexture", texture, texcoord);
  case TextureSlot::emissive:
    return set_texture(material, "emissiveTexture", texture, texcoord);
  case TextureSlot::normal:
    set_texture(material, "normalTexture", texture, texcoord);
    material["normalTexture"].erase("scale");
  }
}

void show_atlas(Json& material, const AtlasLook& look) {
  for (const auto& [slot, texture] : look.textures) set_slot(material, slot, texture, look);
  if (!look.plain_base_color) return;
  if (Json* pbr = find(material, "pbrMetallicRoughness")) pbr->erase("baseColorFactor");
  if (Json* older = find_path(material, "extensions", specular_glossiness)) older->erase("diffuseFactor");
}

std::string mesh_name(const Json& mesh, std::size_t number) {
  const Json* name = find(mesh, "name");
  return name && name->is_string() ? name->get<std::string>() : "mesh " + std::to_string(number);
}

// Numbers, not pointers, name the parts of the document: a key that is added moves all others.
class AtlasMaterials {
public:
  AtlasMaterials(Json& document, const std::vector<AtlasUser>& users) : document_(document) {
    if (!find(document_, "materials")) document_["materials"] = Json::array();
    for (const AtlasUser& user : users) look_of_[{user.mesh, user.primitive}] = &user.look;
    find_shared();
  }

  void assign(const AtlasUser& user) {
    Json& primitive = document_["meshes"][user.mesh]["primitives"][user.primitive];
    const std::size_t before = material_of(primitive);
    const std::size_t after = replacement(before, user);
    primitive["material"] = after;
    Json* mappings = variant_mappings(primitive);
    if (!mappings || before == no_material) return;
    for (Json& mapping : *mappings) {
      if (material_of(mapping) == before) mapping["material"] = after;
    }
  }

  [[nodiscard]] const std::vector<PartCopy>& copies() const { return copies_; }

private:
  // A material may be changed in place if all who use it show the atlas alike.
  void find_shared() {
    std::map<std::size_t, const AtlasLook*> look; // of the first user of each material
    Json& meshes = document_["meshes"];
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      Json& primitives = meshes[m]["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const std::size_t own = material_of(primitives[p]);
        const auto user = look_of_.find({m, p});
        if (user == look_of_.end() || *look.try_emplace(own, user->second).first->second != *user->second) {
          shared_.insert(own);
        }
        share_variants(primitives[p], own);
      }
    }
  }

  void share_variants(Json& primitive, std::size_t own) {
    const Json* mappings = variant_mappings(primitive);
    if (!mappings) return;
    for (const Json& mapping : *mappings) {
      if (material_of(mapping) != own) shared_.insert(material_of(mapping));
    }
  }

  std::size_t replacement(std::size_t material, const AtlasUser& user) {
    // Primitives without a material share one for each mesh.
    const std::tuple key{material, material == no_material ? user.mesh : 0, user.look};
    if (const auto known = replacements_.find(key); known != replacements_.end()) return known->second;
    Json& materials = document_["materials"];
    std::size_t number = material;
    if (material == no_material) {
      number = materials.size();
      materials.push_back(Json{{"name", mesh_name(document_["meshes"][user.mesh], user.mesh)},
                               {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.8}}}});
    } else if (shared_.contains(material)) {
      number = materials.size();
      materials.push_back(Json(materials[material]));
      copies_.push_back({material, number});
    }
    show_atlas(materials[number], user.look);
    replacements_.emplace(key, number);
    return number;
  }

  Json& document_;
  std::map<std::pair<std::size_t, std::size_t>, const AtlasLook*> look_of_;
  std::set<std::size_t> shared_;
  std::map<std::tuple<std::size_t, std::size_t, AtlasLook>, std::size_t> replacements_;
  std::vector<PartCopy> copies_;
};

} // namespace

const Json* texture_info(const Json& material, TextureSlot slot) {
  const Json* info = nullptr;
  switch (slot) {
  case TextureSlot::base_color:
    info = find_path(material, "pbrMetallicRoughness", "baseColorTexture");
    if (!info) info = find_path(material, "extensions", specular_glossiness, "diffuseTexture");
    break;
  case TextureSlot::metallic_roughness:
    info = find_path(material, "pbrMetallicRoughness", "metallicRoughnessTexture");
    break;
  case TextureSlot::occlusion:
    info = find(material, "occlusionTexture");
    break;
  case TextureSlot::emissive:
    info = find(material, "emissiveTexture");
    break;
  case TextureSlot::normal:
    info = find(material, "normalTexture");
    break;
  }
  return info && info->is_object() ? info : nullptr;
}

const Json* material_of(const Asset& asset, const Primitive& primitive) {
  return primitive.material ? &asset.document->json["materials"][*primitive.material] : nullptr;
}

std::array<float, 4> base_color_factor(const Asset& asset, const Primitive& primitive) {
  std::array<float, 4> out{1, 1, 1, 1};
  const Json* material = material_of(asset, primitive);
  if (!material) return out;
  const Json* factor = find_path(*material, "extensions", specular_glossiness, "diffuseFactor");
  if (!factor) factor = find_path(*material, "pbrMetallicRoughness", "baseColorFactor");
  if (!factor || !factor->is_array()) return out;
  for (std::size_t k = 0; k < std::min(out.size(), factor->size()); ++k)
    if ((*factor)[k].is_number()) out[k] = std::clamp((*factor)[k].get<float>(), 0.0F, 1.0F);
  return out;
}

texture::Alpha alpha_of(const Asset& asset, const Primitive& primitive) {
  texture::Alpha out;
  const Json* material = material_of(asset, primitive);
  const Json* mode = material ? find(*material, "alphaMode") : nullptr;
  if (!mode || !mode->is_string()) return out;
  if (*mode == "MASK") out.mode = texture::AlphaMode::mask;
  if (*mode == "BLEND") out.mode = texture::AlphaMode::blend;
  if (const Json* cutoff = find(*material, "alphaCutoff"); cutoff && cutoff->is_number())
    out.cutoff = cutoff->get<float>();
  return out;
}

bool is_double_sided(const Asset& asset, const Primitive& primitive) {
  const Json* material = material_of(asset, primitive);
  const Json* flag = material ? find(*material, "doubleSided") : nullptr;
  return flag && flag->is_boolean() && flag->get<bool>();
}

bool shows_back_faces(const Asset& asset, const Primitive& primitive) {
  const bool tells_sides = asset.format == ModelFormat::glb || asset.format == ModelFormat::gltf;
  return !tells_sides || is_double_sided(asset, primitive);
}

std::vector<PartCopy> assign_atlas(Json& document, const std::vector<AtlasUser>& users) {
  AtlasMaterials materials(document, users);
  for (const AtlasUser& user : users) materials.assign(user);
  return materials.copies();
}

void LevelMaterials::assign(Json& primitive, const AtlasLook& look) {
  if (look.textures.empty()) return;
  const std::size_t before = material_of(primitive);
  if (before == no_material) throw Error(ErrorCode::internal, "a level's primitive has no material to vary");
  primitive["material"] = copy_of(before, look);
  Json* mappings = variant_mappings(primitive);
  const auto normal = look.textures.find(TextureSlot::normal);
  if (!mappings || normal == look.textures.end()) return;
  // The level's normals are those that its normal map is for, whatever material shows it.
  const AtlasLook of_variants{look.texcoord, {*normal}, false};
  for (Json& mapping : *mappings) {
    const std::size_t material = material_of(mapping);
    if (material != no_material) mapping["material"] = copy_of(material, material == before ? look : of_variants);
  }
}

std::size_t LevelMaterials::copy_of(std::size_t material, const AtlasLook& look) {
  const auto [known, is_new] = copies_.try_emplace({material, look}, document_["materials"].size());
  if (is_new) {
    Json copy = document_["materials"][material];
    show_atlas(copy, look);
    document_["materials"].push_back(std::move(copy));
    made_.push_back({material, known->second});
  }
  return known->second;
}

} // namespace orbis::asset
