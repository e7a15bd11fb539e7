#include <algorithm>
#include <set>

#include "core/asset/added_target.h"
#include "core/asset/animated_property.h"
#include "core/asset/asset.h"
#include "core/asset/draco_encoder.h"
#include "core/asset/extensions.h"
#include "core/asset/levels.h"
#include "core/asset/materials.h"
#include "core/asset/mirrored_instances.h"
#include "core/asset/output.h"

namespace orbis::asset {
namespace {

void erase_extension(Json& owner, std::string_view name) {
  Json* extensions = find(owner, "extensions");
  if (!extensions) return;
  extensions->erase(std::string(name));
  if (extensions->empty()) owner.erase("extensions");
}

Json write_attributes(Output& out, std::span<const Attribute> attributes) {
  Json json = Json::object();
  for (const Attribute& attribute : attributes) json[attribute.name] = out.add_attribute(attribute);
  return json;
}

// Indices and attributes, with Draco or as the output stores them. Morph targets stay outside of the Draco data, as the
// extension asks.
void write_geometry(Output& out, Json& primitive, const NewPrimitive& source, Compression compression) {
  const std::size_t vertices = source.attributes.front().count();
  if (compression != Compression::draco || !can_be_draco(source.indices, source.attributes)) {
    primitive["attributes"] = write_attributes(out, source.attributes);
    primitive["indices"] = out.add_indices(source.indices, vertices);
    return;
  }
  Json accessors = Json::object(), ids = Json::object();
  for (std::size_t i = 0; i < source.attributes.size(); ++i) {
    accessors[source.attributes[i].name] = out.add_accessor(accessor_of(source.attributes[i]));
    ids[source.attributes[i].name] = i;
  }
  primitive["attributes"] = std::move(accessors);
  primitive["indices"] = out.add_accessor(accessor_of_indices(source.indices.size(), vertices));
  const std::size_t view = out.add_view(encode_draco(source.indices, source.attributes));
  primitive["extensions"][std::string(draco_extension)] = Json{{"bufferView", view}, {"attributes", std::move(ids)}};
}

// What a caller must not hand over, since no valid document could hold it.
void check_new_primitive(const NewPrimitive& primitive, std::size_t images) {
  const auto all_have = [](const std::vector<Attribute>& attributes, std::size_t count) {
    return std::all_of(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.count() == count; });
  };
  const std::size_t vertices = primitive.attributes.empty() ? 0 : primitive.attributes.front().count();
  const std::string atlas = "TEXCOORD_" + std::to_string(primitive.atlas_texcoord);
  const bool is_sound =
      all_have(primitive.attributes, vertices) && primitive.indices.size() % 3 == 0 &&
      std::all_of(primitive.textures.begin(), primitive.textures.end(),
                  [&](const auto& texture) { return texture.second < images; }) &&
      std::all_of(primitive.targets.begin(), primitive.targets.end(),
                  [&](const auto& target) { return all_have(target, vertices); }) &&
      std::all_of(primitive.indices.begin(), primitive.indices.end(), [&](std::uint32_t i) { return i < vertices; }) &&
      std::any_of(primitive.attributes.begin(), primitive.attributes.end(),
                  [&](const Attribute& a) { return a.name == atlas; });
  if (!is_sound) throw Error(ErrorCode::internal, "a new primitive's indices and attributes do not fit together");
}

// A primitive of the document with new geometry.
Json with_geometry(Output& out, Json primitive, const NewPrimitive& source, Compression compression) {
  // These describe the old vertices by their numbers.
  erase_extension(primitive, draco_extension);
  erase_extension(primitive, "CESIUM_primitive_outline");
  write_geometry(out, primitive, source, compression);
  primitive.erase("mode"); // triangles are the default
  if (source.targets.empty()) {
    primitive.erase("targets");
  } else {
    Json targets = Json::array();
    for (const auto& target : source.targets) targets.push_back(write_attributes(out, target));
    primitive["targets"] = std::move(targets);
  }
  return primitive;
}

// The vertices that `indices` use, in their order, and the indices renumbered.
NewPrimitive part_of(const Primitive& old, std::span<const std::uint32_t> indices) {
  constexpr std::uint32_t unused = UINT32_MAX;
  std::vector<std::uint32_t> number(old.vertex_count(), unused), vertices;
  NewPrimitive out;
  out.indices.reserve(indices.size());
  for (const std::uint32_t v : indices) {
    if (number[v] == unused) {
      number[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(v);
    }
    out.indices.push_back(number[v]);
  }
  const auto take = [&](const Attribute& a) {
    Attribute taken = a;
    const std::size_t size = a.components * size_of(a.type);
    taken.data.clear();
    taken.data.reserve(vertices.size() * size);
    for (const std::uint32_t v : vertices) {
      const auto first = a.data.begin() + static_cast<std::ptrdiff_t>(v * size);
      taken.data.insert(taken.data.end(), first, first + static_cast<std::ptrdiff_t>(size));
    }
    return taken;
  };
  std::transform(old.attributes.begin(), old.attributes.end(), std::back_inserter(out.attributes), take);
  for (const std::vector<Attribute>& target : old.targets) {
    out.targets.emplace_back();
    std::transform(target.begin(), target.end(), std::back_inserter(out.targets.back()), take);
  }
  return out;
}

// Before the primitive itself is replaced: what is left out looks as it did.
void append_left_out(Output& out, const Primitive& old, const NewPrimitive& source, Compression compression) {
  if (source.left_out.empty()) return;
  const Json as_it_was = out.json["meshes"][old.mesh]["primitives"][old.primitive];
  Json primitive = with_geometry(out, as_it_was, part_of(old, source.left_out), compression);
  out.json["meshes"][old.mesh]["primitives"].push_back(std::move(primitive));
}

// Returns what stands there now.
const Json& replace_primitive(Output& out, const Primitive& old, const NewPrimitive& source, Compression compression) {
  erase_extension(out.json["meshes"][old.mesh], "EXT_mesh_manifold");
  // A copy goes in, since views and accessors that are added may move the document's parts.
  Json primitive = with_geometry(out, out.json["meshes"][old.mesh]["primitives"][old.primitive], source, compression);
  return out.json["meshes"][old.mesh]["primitives"][old.primitive] = std::move(primitive);
}

template <class T> std::size_t append(Json& json, const char* array, T item) {
  if (!json[array].is_array()) json[array] = Json::array();
  json[array].push_back(std::move(item));
  return json[array].size() - 1;
}

constexpr std::string_view webp_extension = "EXT_texture_webp";

// The atlas' images as textures: trilinear, and clamped since its charts touch no border. Returns the first one's
// number; the others follow.
std::size_t add_textures(Output& out, std::span<const NewImage> images) {
  const std::size_t first = array_size(out.json, "textures");
  if (images.empty()) return first;
  const std::size_t sampler =
      append(out.json, "samplers", Json{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}});
  for (const NewImage& image : images) {
    const std::size_t view = out.add_view(image.bytes);
    const std::size_t source =
        append(out.json, "images", Json{{"name", image.name}, {"mimeType", image.mime_type}, {"bufferView", view}});
    Json texture{{"name", image.name}, {"sampler", sampler}};
    if (image.mime_type == "image/webp") {
      texture["extensions"][std::string(webp_extension)] = Json{{"source", source}};
    } else {
      texture["source"] = source;
    }
    append(out.json, "textures", std::move(texture));
  }
  return first;
}

AtlasLook look_of(const NewPrimitive& primitive, std::size_t first_texture) {
  AtlasLook look{primitive.atlas_texcoord, {}, primitive.plain_base_color};
  for (const auto& [slot, image] : primitive.textures) look.textures[slot] = first_texture + image;
  return look;
}

// A GLB holds its images; a URI stays only where the image did not come, or is in a format that has no media type in
// glTF.
void embed_images(Output& out, const Document& document) {
  for (const auto& [number, bytes] : document.images) {
    const std::string_view type = image_type(bytes);
    if (type.empty()) continue;
    Json& image = out.json["images"][number];
    image.erase("uri");
    image["mimeType"] = type;
    image["bufferView"] = out.add_view(bytes);
  }
}

bool is_quantised(std::span<const Attribute> attributes) {
  return std::any_of(attributes.begin(), attributes.end(), [](const Attribute& a) {
    return a.type != ComponentType::f32 && (a.name == "POSITION" || a.name == "NORMAL" || a.name == "TANGENT");
  });
}

void require(Json& json, std::string_view extension) {
  for (const auto* list : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = find(json, list);
    if (!names || std::find(names->begin(), names->end(), extension) == names->end()) append(json, list, extension);
  }
}

// Extensions that the result no longer uses are taken off the lists, and those that it came to need are put on.
void update_extensions(Json& json, const Json& before, std::span<const NewPrimitive> primitives,
                       std::span<const NewImage> images) {
  const std::set<std::string> used = extension_objects(json);
  std::set<std::string> gone;
  for (const std::string& name : extension_objects(before)) {
    if (!used.contains(name)) gone.insert(name);
  }
  for (const auto* list : {"extensionsUsed", "extensionsRequired"}) {
    Json* names = find(json, list);
    if (!names) continue;
    Json kept = Json::array();
    for (const Json& name : *names) {
      if (!gone.contains(name.get<std::string>())) kept.push_back(name);
    }
    if (kept.empty()) {
      json.erase(list);
    } else {
      *names = std::move(kept);
    }
  }
  for (const std::string_view coding : {draco_extension, meshopt_extensions[0]}) {
    if (used.contains(std::string(coding))) require(json, coding);
  }
  // Without a fallback in another format.
  if (std::any_of(images.begin(), images.end(), [](const NewImage& i) { return i.mime_type == "image/webp"; })) {
    require(json, webp_extension);
  }
  const bool quantised = std::any_of(primitives.begin(), primitives.end(), [](const NewPrimitive& p) {
    return is_quantised(p.attributes) ||
           std::any_of(p.targets.begin(), p.targets.end(), [](const auto& t) { return is_quantised(t); });
  });
  if (quantised) require(json, quantization_extension);
}

// A mesh that has nothing left stays in the document, which may name it by its number, but no node shows it.
void drop_gone(Json& json, const Asset& asset, std::span<const NewPrimitive> primitives) {
  for (std::size_t i = primitives.size(); i-- > 0;) {
    if (!primitives[i].is_gone) continue;
    const std::size_t m = asset.primitives[i].mesh;
    Json& left = json["meshes"][m]["primitives"];
    if (left.size() > 1) {
      left.erase(asset.primitives[i].primitive);
      continue;
    }
    for (Json& node : json["nodes"]) {
      if (node.value("mesh", json["meshes"].size()) != m) continue;
      for (const char* member : {"mesh", "skin", "weights"}) node.erase(member);
    }
  }
}

void write_extras(Json& json, std::string_view text) {
  Json facts = Json::parse(text, nullptr, false);
  if (!facts.is_object()) throw Error(ErrorCode::internal, "the facts for asset.extras are not a JSON object");
  Json& extras = json["asset"]["extras"];
  // Extras of the input that are no object can take no member: they become one.
  if (!extras.is_object()) extras = extras.is_null() ? Json::object() : Json{{"input", extras}};
  Json& orbis = extras["orbis"];
  if (!orbis.is_object()) orbis = Json::object();
  orbis.update(facts);
}

void note_dropped(const std::vector<std::string>& pointers, std::vector<Asset::Note>* notes) {
  if (notes == nullptr) return;
  for (const std::string& pointer : pointers)
    notes->push_back({"animation-dropped",
                      "an animation moves a texture transform, which is baked into the atlas as it stands at rest: its "
                      "channel is left out",
                      pointer});
}

} // namespace

Bytes write_asset(const Asset& asset, std::span<const NewPrimitive> primitives, std::span<const NewImage> images,
                  std::string_view extras_json, Compression compression, std::span<const NewLevel> levels,
                  std::vector<Asset::Note>* notes) {
  if (primitives.size() != asset.primitives.size()) {
    throw Error(ErrorCode::internal, "there must be one new primitive for each of the asset's");
  }
  const Document& document = *asset.document;
  const bool is_meshopt = compression == Compression::meshopt || compression == Compression::quantized;
  Output out(document, is_meshopt ? GeometryCoding::meshopt : GeometryCoding::plain);
  embed_images(out, document);
  const std::size_t first_texture = add_textures(out, images);
  MirroredInstances mirrored(out, asset);
  std::vector<AtlasUser> users;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Primitive& old = asset.primitives[i];
    if (primitives[i].indices.empty()) continue;
    check_new_primitive(primitives[i], images.size());
    append_left_out(out, old, primitives[i], compression);
    mirrored.add(replace_primitive(out, old, primitives[i], compression), primitives[i]);
    if (!primitives[i].textures.empty())
      users.push_back({old.mesh, old.primitive, look_of(primitives[i], first_texture)});
  }
  std::vector<PartCopy> copies;
  if (!users.empty()) copies = assign_atlas(out.json, users);
  describe_added_targets(out, asset, primitives);
  for (const NewLevel& level : levels)
    for (const NewPrimitive& primitive : level.primitives)
      if (!primitive.indices.empty()) check_new_primitive(primitive, images.size());
  LevelMaterials materials(out.json);
  add_levels(out, asset, primitives, levels, [&](const Json& base, const NewPrimitive& geometry) {
    Json primitive = with_geometry(out, base, geometry, compression);
    materials.assign(primitive, look_of(geometry, first_texture));
    mirrored.add(primitive, geometry);
    return primitive;
  });
  copies.insert(copies.end(), materials.copies().begin(), materials.copies().end());
  note_dropped(drop_dead_channels(out.json, document.json), notes);
  animate_copies(out.json, "materials", copies);
  drop_gone(out.json, asset, primitives);
  mirrored.split();
  if (!document.keeps_numbers) out.drop_unreferenced();
  update_extensions(out.json, document.json, primitives, images);
  write_extras(out.json, extras_json);
  return out.glb();
}

} // namespace orbis::asset
