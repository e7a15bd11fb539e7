#include "core/asset/read_draco_file.h"

#include "core/asset/draco_decoder.h"
#include "core/asset/load_document.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

using Use = DracoMesh::Use;

// How many attributes of each use have been named.
struct Counts {
  std::uint32_t texcoords = 0, colors = 0, generics = 0;
  bool position = false, normal = false;
};

bool is_color_type(ComponentType type) {
  return type == ComponentType::u8 || type == ComponentType::u16 || type == ComponentType::f32;
}

// The glTF attribute that holds a Draco one; its values come later. Attributes with more than four components have no
// place in glTF.
std::optional<Attribute> named(const DracoMesh::Info& info, Counts& counts) {
  if (info.components < 1 || info.components > 4) return std::nullopt;
  const std::uint32_t n = info.components;
  if (info.use == Use::position && n == 3 && !counts.position) {
    counts.position = true;
    return Attribute{"POSITION", ComponentType::f32, false, 3, {}};
  }
  if (info.use == Use::normal && n == 3 && !counts.normal) {
    counts.normal = true;
    return Attribute{"NORMAL", ComponentType::f32, false, 3, {}};
  }
  if (info.use == Use::texcoord && n == 2 && info.type == ComponentType::f32) {
    return Attribute{"TEXCOORD_" + std::to_string(counts.texcoords++), info.type, false, 2, {}};
  }
  if (info.use == Use::color && n >= 3 && is_color_type(info.type)) {
    return Attribute{"COLOR_" + std::to_string(counts.colors++), info.type, info.type != ComponentType::f32, n, {}};
  }
  // glTF has no vertex attributes of 32-bit integers.
  const ComponentType type = info.type == ComponentType::u32 ? ComponentType::f32 : info.type;
  return Attribute{
      "_GENERIC_" + std::to_string(counts.generics++), type, info.normalized && type != ComponentType::f32, n, {}};
}

// Colours of 8 bits come from files of scans and pictures, PLY above all, and are sRGB as there.
bool is_srgb(const Attribute& attribute) {
  return attribute.name.starts_with("COLOR_") && attribute.type == ComponentType::u8;
}

Attribute linear(const Attribute& srgb) {
  Attribute out = linear_colors(srgb.count(), srgb.components);
  out.name = srgb.name;
  for (std::size_t v = 0; v < srgb.count(); ++v) {
    for (std::uint32_t c = 0; c < srgb.components; ++c) {
      const bool is_alpha = c == 3;
      out.set(v, c, is_alpha ? srgb.get(v, c) : linear_from_srgb(srgb.get(v, c)));
    }
  }
  return out;
}

Primitive read_primitive(const DracoMesh& mesh, const Limits& limits, std::vector<Asset::Note>& notes) {
  Primitive out;
  out.indices = mesh.indices();
  Counts counts;
  std::uint64_t bytes = 0;
  for (const DracoMesh::Info& info : mesh.attributes()) {
    auto attribute = named(info, counts);
    if (!attribute) {
      notes.push_back({"attribute-dropped",
                       "attribute " + std::to_string(info.id) + " has " + std::to_string(info.components) +
                           " components; glTF holds at most 4, so it is not carried over",
                       ""});
      continue;
    }
    if (attribute->type != info.type || !info.exact) {
      notes.push_back({"attribute-converted", attribute->name + " is stored as float, which glTF asks for", ""});
    }
    bytes += mesh.vertex_count() * info.components * size_of(attribute->type);
    if (bytes > max_decoded_bytes(limits)) {
      throw Error(ErrorCode::too_large, "the asset has more than the limit of " +
                                            std::to_string(max_decoded_bytes(limits)) + " bytes of vertex data");
    }
    attribute->data = mesh.values(info.id, attribute->type, info.components);
    out.attributes.push_back(is_srgb(*attribute) ? linear(*attribute) : std::move(*attribute));
  }
  if (!counts.position) throw Error(ErrorCode::invalid_geometry, "the Draco mesh has no positions");
  return out;
}

} // namespace

Converted read_draco_file(std::span<const std::byte> bytes, const Limits& limits) {
  Converted out;
  const Primitive primitive = read_primitive(DracoMesh(bytes, limits, {}), limits, out.notes);
  ModelBuilder model;
  const std::size_t mesh = model.add_mesh("");
  // A primitive without triangles is none in glTF; the reader says what an empty model lacks.
  if (!primitive.indices.empty()) model.add_primitive(mesh, primitive.indices, primitive.attributes, std::nullopt);
  out.glb = model.glb();
  return out;
}

} // namespace orbis::asset
