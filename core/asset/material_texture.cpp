#include <algorithm>
#include <cmath>
#include <set>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "core/asset/extensions.h"
#include "core/asset/materials.h"

namespace orbis::asset {
namespace {

// The image of a texture, in a format that can be decoded: a WebP image where the texture has one, else its plain
// source.
std::optional<std::size_t> image_of(const Document& document, const Json& texture) {
  const Json* webp = find_path(texture, "extensions", "EXT_texture_webp", "source");
  for (const Json* source : {webp, find(texture, "source")}) {
    if (!source) continue;
    const auto number = source->get<std::size_t>();
    const auto bytes = document.image(number);
    if (!bytes) continue;
    const std::string_view type = image_type(*bytes);
    if (type != "image/ktx2" && type != "image/avif") return number;
  }
  return std::nullopt;
}

double number_at(const JsonReader& reader, const Json& parent, std::string_view key, std::size_t i, double fallback) {
  const Json* values = reader.array(parent, key);
  if (!values) return fallback;
  if (values->size() != 2 || !values->at(i).is_number()) reader.fail(parent, key, "must hold 2 numbers");
  return values->at(i).get<double>();
}

double rotation_of(const JsonReader& reader, const Json& transform) {
  const Json* rotation = reader.member(transform, "rotation");
  if (!rotation) return 0;
  if (!rotation->is_number()) reader.fail(transform, "rotation", "must be a number");
  return rotation->get<double>();
}

// KHR_texture_transform: scale, then rotate counter-clockwise as seen with v pointing down, then move.
void read_transform(const JsonReader& reader, const Json& transform, MaterialTexture& out) {
  const double angle = rotation_of(reader, transform);
  const double c = std::cos(angle), s = std::sin(angle);
  const double su = number_at(reader, transform, "scale", 0, 1), sv = number_at(reader, transform, "scale", 1, 1);
  const double m[6] = {c * su,  s * sv, number_at(reader, transform, "offset", 0, 0),
                       -s * su, c * sv, number_at(reader, transform, "offset", 1, 0)};
  for (std::size_t i = 0; i < out.transform.size(); ++i) out.transform[i] = static_cast<float>(m[i]);
}

void read_sampler(const Document& document, const JsonReader& reader, const Json& texture, MaterialTexture& out) {
  const auto number = reader.integer(texture, "sampler");
  if (!number) return;
  const Json& sampler = document.json["samplers"][*number];
  const auto wrap = [&](std::string_view key) {
    const auto code = static_cast<int>(reader.integer(sampler, key, 65535).value_or(10497));
    if (code != 33071 && code != 33648 && code != 10497) reader.fail(sampler, key, "is none of 33071, 33648 and 10497");
    return code;
  };
  out.wrap_s = wrap("wrapS");
  out.wrap_t = wrap("wrapT");
  out.nearest = reader.integer(sampler, "magFilter", 65535).value_or(9729) == 9728;
}

float read_scale(const JsonReader& reader, const Json& info) {
  const Json* scale = reader.member(info, "scale");
  if (!scale) return 1;
  if (!scale->is_number()) reader.fail(info, "scale", "must be a number");
  return scale->get<float>();
}

bool has_other_tangent_textures(const Json& material) {
  return find_path(material, "extensions", "KHR_materials_clearcoat", "clearcoatNormalTexture") != nullptr ||
         find_path(material, "extensions", "KHR_materials_anisotropy") != nullptr;
}

const Json* variant_mappings(const Asset& asset, const Primitive& primitive) {
  const Json& json = asset.document->json["meshes"][primitive.mesh]["primitives"][primitive.primitive];
  const Json* found = find_path(json, "extensions", "KHR_materials_variants", "mappings");
  return found && found->is_array() ? found : nullptr;
}

// visit(info) for every texture of a material, whatever extension has it.
template <class Visit> void for_texture_infos(const Json& part, const Visit& visit) {
  if (!part.is_object()) return;
  if (const Json* index = find(part, "index"); index && index->is_number_unsigned()) visit(part);
  for (const auto& [key, member] : part.items())
    if (key != "extras") for_texture_infos(member, visit);
}

// Its own, and those of its variants.
std::vector<const Json*> materials_of(const Asset& asset, const Primitive& primitive) {
  const Json& json = asset.document->json;
  std::vector<const Json*> out;
  if (const Json* own = material_of(asset, primitive)) out.push_back(own);
  if (const Json* mappings = variant_mappings(asset, primitive))
    for (const Json& mapping : *mappings)
      if (const Json* number = find(mapping, "material")) out.push_back(&json["materials"][number->get<std::size_t>()]);
  return out;
}

} // namespace

std::optional<MaterialTexture> material_texture(const Asset& asset, const Primitive& primitive, TextureSlot slot) {
  const Document& document = *asset.document;
  if (!primitive.material) return std::nullopt;
  const Json* info = texture_info(document.json["materials"][*primitive.material], slot);
  if (!info) return std::nullopt;
  const JsonReader reader(document.json);
  const Json& texture = document.json["textures"][reader.required_integer(*info, "index")];
  const auto image = image_of(document, texture);
  if (!image) return std::nullopt;

  MaterialTexture out;
  std::uint64_t set = reader.integer(*info, "texCoord", 1000).value_or(0);
  if (const Json* transform = find_path(*info, "extensions", transform_extension)) {
    read_transform(reader, *transform, out);
    set = reader.integer(*transform, "texCoord", 1000).value_or(set);
  }
  out.uv = "TEXCOORD_" + std::to_string(set);
  if (!primitive.find(out.uv)) return std::nullopt;
  if (slot == TextureSlot::normal) out.scale = read_scale(reader, *info);
  read_sampler(document, reader, texture, out);
  out.image = *document.image(*image);
  out.image_number = *image;
  return out;
}

bool names_texture(const Asset& asset, const Primitive& primitive, TextureSlot slot) {
  const Json* material = material_of(asset, primitive);
  return material && texture_info(*material, slot) != nullptr;
}

std::uint32_t named_texture_sets(const Asset& asset, const Primitive& primitive) {
  constexpr std::uint64_t most = 8;
  std::uint64_t end = 0;
  const JsonReader reader(asset.document->json);
  for (const Json* material : materials_of(asset, primitive))
    for_texture_infos(*material, [&](const Json& info) {
      std::uint64_t set = reader.integer(info, "texCoord", UINT32_MAX).value_or(0);
      if (const Json* transform = find_path(info, "extensions", transform_extension))
        set = reader.integer(*transform, "texCoord", UINT32_MAX).value_or(set);
      end = std::max(end, set + 1);
    });
  return end <= most ? static_cast<std::uint32_t>(end) : 0;
}

bool keeps_textures(const Asset& asset, const Primitive& primitive,
                    const std::map<TextureSlot, std::uint32_t>& replaced) {
  const Json* material = material_of(asset, primitive);
  if (!material) return false;
  std::set<const Json*> gone;
  for (const auto& [slot, image] : replaced) gone.insert(texture_info(*material, slot));
  bool any = false;
  for_texture_infos(*material, [&](const Json& info) { any = any || !gone.contains(&info); });
  return any;
}

bool shares_tangents(const Asset& asset, const Primitive& primitive) {
  const Json& json = asset.document->json;
  if (primitive.material && has_other_tangent_textures(json["materials"][*primitive.material])) return true;
  const Json* mappings = variant_mappings(asset, primitive);
  if (!mappings) return false;
  return std::any_of(mappings->begin(), mappings->end(), [&](const Json& mapping) {
    const Json* number = find(mapping, "material");
    if (!number || number->get<std::size_t>() == primitive.material) return false;
    const Json& material = json["materials"][number->get<std::size_t>()];
    return texture_info(material, TextureSlot::normal) != nullptr || has_other_tangent_textures(material);
  });
}

bool has_variants(const Asset& asset, const Primitive& primitive) {
  const Json* mappings = variant_mappings(asset, primitive);
  return mappings && !mappings->empty();
}

} // namespace orbis::asset
