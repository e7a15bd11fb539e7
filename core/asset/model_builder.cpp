#include "core/asset/model_builder.h"

#include <cmath>

#include "core/asset/uri.h"
#include "core/utf8.h"

namespace orbis::asset {
namespace {

std::size_t append(Json& json, const char* array, Json item) {
  if (!json[array].is_array()) json[array] = Json::array();
  json[array].push_back(std::move(item));
  return json[array].size() - 1;
}

void list_once(Json& json, const char* list, std::string_view extension) {
  for (std::size_t i = 0; i < array_size(json, list); ++i) {
    if (json[list][i] == extension) return;
  }
  append(json, list, extension);
}

// A texture that only this extension can name.
constexpr const char* webp_extension = "EXT_texture_webp";

} // namespace

ModelBuilder::ModelBuilder() : out_(empty_) {
  out_.json["asset"]["version"] = "2.0";
  out_.json["scene"] = 0;
  out_.json["scenes"] = Json::array({Json{{"nodes", Json::array()}}});
}

std::size_t ModelBuilder::add_mesh(std::string_view name, const Vec3d& origin) {
  Json mesh = Json::object(), node = Json::object();
  if (!name.empty()) mesh["name"] = node["name"] = as_utf8(name);
  mesh["primitives"] = Json::array();
  const std::size_t number = append(out_.json, "meshes", std::move(mesh));
  node["mesh"] = number;
  if (origin != Vec3d()) node["translation"] = {origin.x, origin.y, origin.z};
  out_.json["scenes"][0]["nodes"].push_back(append(out_.json, "nodes", std::move(node)));
  return number;
}

void ModelBuilder::add_primitive(std::size_t mesh, std::span<const std::uint32_t> indices,
                                 std::span<const Attribute> attributes, std::optional<std::size_t> material) {
  Json primitive{{"attributes", Json::object()}};
  for (const Attribute& attribute : attributes) {
    primitive["attributes"][attribute.name] = out_.add_attribute(attribute);
  }
  primitive["indices"] = out_.add_indices(indices, attributes.front().count());
  if (material) primitive["material"] = *material;
  out_.json["meshes"][mesh]["primitives"].push_back(std::move(primitive));
}

std::size_t ModelBuilder::add_material(Json material) { return append(out_.json, "materials", std::move(material)); }

std::size_t ModelBuilder::sampler(bool repeats) {
  const int wrap = repeats ? 10497 : 33071;
  for (std::size_t i = 0; i < array_size(out_.json, "samplers"); ++i) {
    if (out_.json["samplers"][i]["wrapS"] == wrap) return i;
  }
  return append(out_.json, "samplers",
                Json{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", wrap}, {"wrapT", wrap}});
}

void ModelBuilder::use_extension(std::string_view name) { list_once(out_.json, "extensionsUsed", name); }

std::size_t ModelBuilder::add_texture(std::string_view name, std::span<const std::byte> image, bool repeats) {
  const std::string_view type = image_type(image);
  Json json{{"mimeType", type}, {"bufferView", out_.add_view(Bytes(image.begin(), image.end()))}};
  if (!name.empty()) json["name"] = as_utf8(name);
  const std::size_t source = append(out_.json, "images", std::move(json));
  Json texture{{"sampler", sampler(repeats)}};
  if (type == "image/webp") {
    texture["extensions"][webp_extension]["source"] = source;
    list_once(out_.json, "extensionsUsed", webp_extension);
    list_once(out_.json, "extensionsRequired", webp_extension);
  } else {
    texture["source"] = source;
  }
  return append(out_.json, "textures", std::move(texture));
}

Bytes ModelBuilder::glb() { return out_.glb(); }

bool make_unit(Attribute& normals) {
  for (std::size_t v = 0; v < normals.count(); ++v) {
    const Vec3d n(normals.get(v, 0), normals.get(v, 1), normals.get(v, 2));
    const double length = norm(n);
    if (!(length > 0) || !std::isfinite(length)) return false;
    if (std::abs(length - 1) < 1e-6) continue; // as good as a float can say it: kept to the bit
    normals.set(v, 0, n.x / length);
    normals.set(v, 1, n.y / length);
    normals.set(v, 2, n.z / length);
  }
  return true;
}

std::optional<std::size_t> add_texture_file(ModelBuilder& model, const ModelFiles& files, std::string_view name,
                                            std::vector<Asset::Note>& notes, bool repeats) {
  const Bytes* image = files.find(name, "");
  if (image == nullptr) {
    notes.push_back({"image-missing", "the image '" + shown(name) + "' did not come with the request", ""});
    return std::nullopt;
  }
  const std::string_view type = image_type(*image);
  if (type != "image/png" && type != "image/jpeg" && type != "image/webp") {
    notes.push_back(
        {"image-not-carried-over",
         "the image '" + shown(name) + "' is neither PNG, JPEG nor WebP, which is what glTF holds; convert it", ""});
    return std::nullopt;
  }
  return model.add_texture(name, *image, repeats);
}

} // namespace orbis::asset
