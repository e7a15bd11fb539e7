#include "core/asset/mtl_reader.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "core/asset/extensions.h"
#include "core/asset/mtl_options.h"
#include "core/asset/uri.h"
#include "core/utf8.h"

namespace orbis::asset {
namespace {

using Material = tinyobj::material_t;
using Options = tinyobj::texture_option_t;

// Blinn's specular exponent as glTF's roughness: alpha = roughness^2 and alpha^2 = 2 / (exponent + 2)
// (B. Walter et al., Microfacet Models for Refraction through Rough Surfaces, 2007, section 5.2).
double roughness_of(double exponent) { return std::pow(2 / (std::max(exponent, 0.0) + 2), 0.25); }

double unit(double value) { return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 1.0; }

Json color(const tinyobj::real_t (&rgb)[3]) {
  return Json::array({unit(double{rgb[0]}), unit(double{rgb[1]}), unit(double{rgb[2]})});
}

// MTL counts v upward, where u' = su u + ou and v' = sv v + ov; glTF downward: V = 1 - v. So
// V' = 1 - (sv (1 - V) + ov) = sv V + (1 - sv - ov).
std::optional<Json> transform_of(const Options& options) {
  const double su{options.scale[0]}, sv{options.scale[1]}, ou{options.origin_offset[0]}, ov{options.origin_offset[1]};
  if (su == 1 && sv == 1 && ou == 0 && ov == 0) return std::nullopt;
  if (!std::isfinite(su + sv + ou + ov)) return std::nullopt;
  return Json{{"offset", {ou, 1 - sv - ov}}, {"scale", {su, sv}}};
}

Json texture_info(const std::string& file, const Options& options) {
  Json out{{"file", file}};
  if (options.clamp) out["clamp"] = true;
  if (auto transform = transform_of(options)) {
    out["extensions"][std::string(transform_extension)] = std::move(*transform);
  }
  return out;
}

bool has_bump_scale(const Options& options) {
  return options.bump_multiplier != 1 && std::isfinite(options.bump_multiplier);
}

// Diffuse colour and map become the base colour. Where there is a map it is the whole colour: most programs write a
// grey of no meaning beside it.
Json base_color(const Material& material) {
  Json pbr = Json::object();
  if (material.diffuse_texname.empty()) {
    pbr["baseColorFactor"] = color(material.diffuse);
    pbr["baseColorFactor"].push_back(unit(double{material.dissolve}));
  } else {
    if (material.dissolve < 1) pbr["baseColorFactor"] = {1, 1, 1, unit(double{material.dissolve})};
    pbr["baseColorTexture"] = texture_info(material.diffuse_texname, material.diffuse_texopt);
  }
  const bool has_roughness = material.roughness > 0 || material.metallic > 0;
  pbr["metallicFactor"] = unit(double{material.metallic});
  pbr["roughnessFactor"] =
      has_roughness ? unit(double{material.roughness}) : unit(roughness_of(double{material.shininess}));
  return pbr;
}

Json gltf_material(const Material& material) {
  Json out{{"name", as_utf8(material.name)}, {"pbrMetallicRoughness", base_color(material)}};
  if (!material.normal_texname.empty()) {
    out["normalTexture"] = texture_info(material.normal_texname, material.normal_texopt);
    if (has_bump_scale(material.normal_texopt)) out["normalTexture"]["scale"] = material.normal_texopt.bump_multiplier;
  }
  if (!material.emissive_texname.empty()) {
    out["emissiveTexture"] = texture_info(material.emissive_texname, material.emissive_texopt);
    out["emissiveFactor"] = {1, 1, 1};
  } else if (material.emission[0] > 0 || material.emission[1] > 0 || material.emission[2] > 0) {
    out["emissiveFactor"] = color(material.emission);
  }
  // An opacity map of its own has no place in glTF; most often it is the alpha of the diffuse map.
  const bool cuts_out = !material.alpha_texname.empty() && material.alpha_texname == material.diffuse_texname;
  if (material.dissolve < 1 || cuts_out) out["alphaMode"] = "BLEND";
  return out;
}

using Map = std::pair<const char*, const std::string*>;

// Maps that repeat the diffuse map's image say nothing of their own: the ambient one in many files, and opacity, which
// is the image's alpha.
void note_lost_maps(const Material& material, std::vector<Asset::Note>& notes) {
  const std::array<Map, 10> maps{{{"bump", &material.bump_texname},
                                  {"displacement", &material.displacement_texname},
                                  {"specular", &material.specular_texname},
                                  {"roughness", &material.roughness_texname},
                                  {"metallic", &material.metallic_texname},
                                  {"reflection", &material.reflection_texname},
                                  {"ambient", &material.ambient_texname},
                                  {"opacity", &material.alpha_texname},
                                  {"specular exponent", &material.specular_highlight_texname},
                                  {"sheen", &material.sheen_texname}}};
  for (const auto& [kind, file] : maps) {
    const bool may_repeat = file == &material.ambient_texname || file == &material.alpha_texname;
    if (file->empty() || (may_repeat && *file == material.diffuse_texname)) continue;
    notes.push_back({"map-not-carried-over",
                     "the " + std::string(kind) + " map '" + shown(*file) + "' of the material '" +
                         shown(material.name) + "' has no place of its own in glTF and is not carried over",
                     ""});
  }
}

std::string lost_options(const Options& options) {
  const bool is_turbulent = std::ranges::any_of(options.turbulence, [](float t) { return t != 0; });
  std::string out;
  if (options.brightness != 0 || options.contrast != 1) out += " -mm";
  if (is_turbulent) out += " -t";
  if (options.imfchan != 'm') out += " -imfchan";
  return out;
}

void note_lost_options(const Material& material, std::vector<Asset::Note>& notes) {
  struct {
    const char* kind;
    const std::string& file;
    const Options& options;
    bool is_normal_map;
  } const maps[]{{"diffuse", material.diffuse_texname, material.diffuse_texopt, false},
                 {"emissive", material.emissive_texname, material.emissive_texopt, false},
                 {"normal", material.normal_texname, material.normal_texopt, true}};
  for (const auto& map : maps) {
    std::string lost = lost_options(map.options);
    if (!map.is_normal_map && map.options.bump_multiplier != 1) lost += " -bm";
    if (map.file.empty() || lost.empty()) continue;
    notes.push_back({"map-options-not-carried-over",
                     "the options" + lost + " of the " + map.kind + " map of the material '" + shown(material.name) +
                         "' have no place in glTF and are not carried over",
                     ""});
  }
}

} // namespace

std::vector<MtlMaterial> read_mtl(std::span<const std::byte> library) {
  std::istringstream text(with_all_option_numbers(library));
  std::map<std::string, int> numbers;
  std::vector<Material> materials;
  std::string warning, error;
  tinyobj::LoadMtl(&numbers, &materials, &text, &warning, &error);
  std::vector<MtlMaterial> out;
  out.reserve(materials.size());
  for (const Material& material : materials) {
    MtlMaterial& read = out.emplace_back(MtlMaterial{material.name, gltf_material(material), {}});
    note_lost_maps(material, read.notes);
    note_lost_options(material, read.notes);
  }
  return out;
}

} // namespace orbis::asset
