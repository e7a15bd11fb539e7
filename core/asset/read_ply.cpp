#include "core/asset/read_ply.h"

#include <algorithm>

#include "core/asset/ply_parts.h"

namespace orbis::asset {
namespace {

struct Contents {
  PlyVertices vertices;
  PlyFaces faces;
};

void skip_element(const PlyElement& element, PlyValues& values, std::vector<Asset::Note>& notes) {
  if (element.count > 0) {
    notes.push_back({"element-not-carried-over",
                     "the " + std::to_string(element.count) + " rows of the element " +
                         TextReader::quoted(element.name) + " are not carried over",
                     ""});
  }
  for (std::uint64_t row = 0; row < element.count && !element.properties.empty(); ++row) {
    for (const PlyProperty& property : element.properties) values.skip(property);
  }
}

Contents read_elements(const PlyHeader& header, PlyValues& values, const Limits& limits,
                       std::vector<Asset::Note>& notes) {
  Contents out;
  for (const PlyElement& element : header.elements) {
    values.check_count(element);
    if (element.name == "vertex") {
      if (element.count > limits.max_vertices) {
        values.fail("there are more than the limit of " + std::to_string(limits.max_vertices) + " vertices",
                    ErrorCode::too_large);
      }
      out.vertices = read_ply_vertices(element, values, notes);
    } else if (element.name == "face") {
      if (out.vertices.attributes.empty()) {
        values.fail("the faces come before the vertices", ErrorCode::unsupported_feature);
      }
      out.faces = read_ply_faces(element, values, out.vertices, header.textures.size(), limits, notes);
    } else {
      skip_element(element, values, notes);
    }
  }
  return out;
}

// A material for a part that has a texture and coordinates for it.
std::optional<std::size_t> material_of(const PlyPart& part, const std::vector<std::string>& textures,
                                       const ModelFiles& files, ModelBuilder& model, std::vector<Asset::Note>& notes) {
  const bool has_texcoords =
      std::ranges::find(part.attributes, "TEXCOORD_0", &Attribute::name) != part.attributes.end();
  if (!has_texcoords || part.texture >= textures.size() || textures[part.texture].empty()) return std::nullopt;
  const auto texture = add_texture_file(model, files, textures[part.texture], notes);
  if (!texture) return std::nullopt;
  return model.add_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", *texture}}}, {"metallicFactor", 0}}}});
}

} // namespace

Converted read_ply(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files) {
  TextReader text(bytes, "the PLY file");
  const PlyHeader header = read_ply_header(text);
  PlyValues values(text, header.form);
  Converted out;
  Contents contents = read_elements(header, values, limits, out.notes);
  if (contents.faces.indices.empty()) {
    throw Error(ErrorCode::invalid_geometry,
                "the PLY file has no faces: points alone are no surface; reconstruct one first");
  }
  std::erase_if(contents.vertices.attributes, [&](Attribute& a) {
    if (a.name != "NORMAL" || make_unit(a)) return false;
    out.notes.push_back({"normals-left-out", "a normal has no direction, so that all were left out", ""});
    return true;
  });
  const Vec3d origin = contents.vertices.origin;
  const std::vector<PlyPart> parts = ply_parts(std::move(contents.vertices), std::move(contents.faces));
  ModelBuilder model;
  std::vector<std::optional<std::size_t>> materials;
  materials.reserve(parts.size());
  for (const PlyPart& part : parts) {
    materials.push_back(material_of(part, header.textures, files, model, out.notes));
  }
  const std::size_t mesh = model.add_mesh("", origin);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    model.add_primitive(mesh, parts[i].indices, parts[i].attributes, materials[i]);
  }
  out.glb = model.glb();
  return out;
}

} // namespace orbis::asset
