#include "core/asset/materials.h"

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

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

void show_atlas(Json& material, std::size_t texture, std::uint32_t texcoord) {
  set_texture(material["pbrMetallicRoughness"], "baseColorTexture", texture, texcoord);
  if (Json* older = find_path(material, "extensions", specular_glossiness); older && older->is_object()) {
    set_texture(*older, "diffuseTexture", texture, texcoord);
  }
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
    for (const AtlasUser& user : users) shown_by_[{user.mesh, user.primitive}] = {user.texcoord, user.texture};
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

private:
  // What a primitive shows: a texture by some texture coordinates.
  using Shown = std::pair<std::uint32_t, std::size_t>;

  // A material may be changed in place if all who use it show the same page with the same texture coordinates.
  void find_shared() {
    std::map<std::size_t, Shown> first; // by the first user of each material
    Json& meshes = document_["meshes"];
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      Json& primitives = meshes[m]["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const std::size_t own = material_of(primitives[p]);
        const auto user = shown_by_.find({m, p});
        if (user == shown_by_.end() || first.try_emplace(own, user->second).first->second != user->second) {
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
    const std::tuple key{material, material == no_material ? user.mesh : 0, user.texcoord, user.texture};
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
    }
    show_atlas(materials[number], user.texture, user.texcoord);
    replacements_.emplace(key, number);
    return number;
  }

  Json& document_;
  std::map<std::pair<std::size_t, std::size_t>, Shown> shown_by_; // by mesh and primitive
  std::set<std::size_t> shared_;
  std::map<std::tuple<std::size_t, std::size_t, std::uint32_t, std::size_t>, std::size_t> replacements_;
};

} // namespace

const Json* base_color_texture(const Json& material) {
  const Json* info = find_path(material, "pbrMetallicRoughness", "baseColorTexture");
  if (!info) info = find_path(material, "extensions", specular_glossiness, "diffuseTexture");
  return info && info->is_object() ? info : nullptr;
}

void assign_atlas(Json& document, const std::vector<AtlasUser>& users) {
  AtlasMaterials materials(document, users);
  for (const AtlasUser& user : users) materials.assign(user);
}

} // namespace orbis::asset
