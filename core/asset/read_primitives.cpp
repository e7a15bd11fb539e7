#include "core/asset/read_primitives.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/asset/accessor_layout.h"
#include "core/asset/accessor_reader.h"
#include "core/asset/draco_decoder.h"
#include "core/asset/extensions.h"
#include "core/asset/load_document.h"
#include "core/asset/triangulate.h"
#include "core/asset/typed_model.h"
#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

// What all primitives together may take: many of them can share one accessor, and each gets its own copy.
class Budget {
public:
  explicit Budget(const Limits& limits) : limits_(limits) {}

  void add_vertices(std::uint64_t n, const std::string& where) {
    take(vertices_ += n, limits_.max_vertices, "vertices", where);
  }
  void add_triangles(std::uint64_t n, const std::string& where) {
    take(triangles_ += n, limits_.max_triangles, "triangles", where);
  }
  void add_bytes(std::uint64_t n, const std::string& where) {
    take(bytes_ += n, max_decoded_bytes(limits_), "bytes of vertex data", where);
  }

private:
  static void take(std::uint64_t total, std::uint64_t limit, const std::string& what, const std::string& where) {
    if (total <= limit) return;
    throw Error(ErrorCode::too_large, "the asset has more than the limit of " + std::to_string(limit) + " " + what,
                where);
  }

  const Limits& limits_;
  std::uint64_t vertices_ = 0, triangles_ = 0, bytes_ = 0;
};

// Components that the specification fixes for an attribute; 0 where any vector will do.
std::vector<std::uint32_t> components_allowed(std::string_view name, bool is_target) {
  if (name == "POSITION" || name == "NORMAL") return {3};
  if (name == "TANGENT") return {is_target ? 3u : 4u};
  const std::string_view family = name.substr(0, name.find('_'));
  if (family == "TEXCOORD") return {2};
  if (family == "COLOR") return {3, 4};
  if (family == "JOINTS" || family == "WEIGHTS") return {4};
  return {1, 2, 3, 4};
}

// Reads one primitive after the other.
class PrimitiveReader {
public:
  PrimitiveReader(const Document& document, const tinygltf::Model& model, const Limits& limits,
                  std::vector<Asset::Note>& notes)
      : document_(document), model_(model), limits_(limits), accessors_(document, model), budget_(limits),
        notes_(notes) {}

  std::optional<Primitive> read(std::uint32_t mesh, std::uint32_t index);

private:
  [[nodiscard]] std::string where(std::string_view part = {}) const { return where_ + std::string(part); }
  std::vector<Attribute> read_attributes(const Json& names, const DracoMesh* compressed, bool is_target,
                                         const std::string& place);
  std::optional<Attribute> read_attribute(const std::string& name, std::size_t accessor, const DracoMesh* compressed,
                                          bool is_target, const std::string& place);
  std::vector<std::uint32_t> read_indices(const tinygltf::Primitive& primitive, std::size_t vertices);
  void note(std::string code, std::string message, std::string place) {
    notes_.push_back({std::move(code), std::move(message), std::move(place)});
  }

  const Document& document_;
  const tinygltf::Model& model_;
  const Limits& limits_;
  AccessorReader accessors_;
  Budget budget_;
  std::vector<Asset::Note>& notes_;
  const Json* json_ = nullptr;      // the primitive at hand
  const Json* draco_ids_ = nullptr; // its attributes in the Draco data: name -> id
  std::size_t vertices_ = 0;
  std::string where_;
};

std::unique_ptr<DracoMesh> decode_draco(const Document& document, const Json& extension, const Limits& limits,
                                        const std::string& where) {
  const JsonReader reader(document.json);
  const auto view = reader.required_integer(extension, "bufferView");
  return std::make_unique<DracoMesh>(document.view(view), limits, where);
}

std::optional<Primitive> PrimitiveReader::read(std::uint32_t mesh, std::uint32_t index) {
  const tinygltf::Primitive& typed = model_.meshes.at(mesh).primitives.at(index);
  if (typed.mode < TINYGLTF_MODE_TRIANGLES) return std::nullopt;
  json_ = &document_.json["meshes"][mesh]["primitives"][index];
  where_ = "/meshes/" + std::to_string(mesh) + "/primitives/" + std::to_string(index);
  const auto position = typed.attributes.find("POSITION");
  if (position == typed.attributes.end()) {
    throw Error(ErrorCode::invalid_geometry, "the primitive has no POSITION attribute", where());
  }
  vertices_ = accessors_.accessor(static_cast<std::size_t>(position->second)).count;
  budget_.add_vertices(vertices_, where());

  std::unique_ptr<DracoMesh> compressed;
  draco_ids_ = nullptr;
  if (const Json* extension = find_path(*json_, "extensions", draco_extension)) {
    compressed = decode_draco(document_, *extension, limits_, where());
    draco_ids_ = &JsonReader(document_.json).required_object(*extension, "attributes");
    if (compressed->vertex_count() != vertices_) {
      throw Error(ErrorCode::malformed, "the Draco data has another number of vertices than the accessors", where());
    }
  }

  Primitive out{mesh, index, {}, {}, {}, std::nullopt};
  if (typed.material >= 0) out.material = static_cast<std::uint32_t>(typed.material);
  out.attributes = read_attributes((*json_)["attributes"], compressed.get(), false, where("/attributes"));
  out.indices = compressed ? compressed->indices() : read_indices(typed, vertices_);
  budget_.add_triangles(out.indices.size() / 3, where());
  if (const Json* targets = find(*json_, "targets")) {
    for (std::size_t t = 0; t < targets->size(); ++t) {
      out.targets.push_back(read_attributes((*targets)[t], nullptr, true, where("/targets/" + std::to_string(t))));
    }
  }
  return out;
}

std::vector<Attribute> PrimitiveReader::read_attributes(const Json& names, const DracoMesh* compressed, bool is_target,
                                                        const std::string& place) {
  std::vector<Attribute> out;
  const std::string inside = place + "/";
  for (const auto& [name, accessor] : names.get_ref<const Json::object_t&>()) {
    auto attribute = read_attribute(name, accessor.get<std::size_t>(), compressed, is_target, inside + name);
    if (attribute) out.push_back(std::move(*attribute));
  }
  return out;
}

std::optional<Attribute> PrimitiveReader::read_attribute(const std::string& name, std::size_t accessor,
                                                         const DracoMesh* compressed, bool is_target,
                                                         const std::string& place) {
  const tinygltf::Accessor& typed = accessors_.accessor(accessor);
  if (typed.type == TINYGLTF_TYPE_MAT2 || typed.type == TINYGLTF_TYPE_MAT3 || typed.type == TINYGLTF_TYPE_MAT4) {
    note("attribute-dropped", "the attribute '" + shown(name) + "' has a matrix per vertex and is not carried over",
         place);
    return std::nullopt;
  }
  const auto components =
      static_cast<std::uint32_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(typed.type)));
  const auto allowed = components_allowed(name, is_target);
  if (std::find(allowed.begin(), allowed.end(), components) == allowed.end()) {
    throw Error(ErrorCode::malformed, "the attribute has the wrong type: " + std::string(vector_type(components)),
                place);
  }
  if (typed.count != vertices_) {
    throw Error(ErrorCode::malformed,
                "the attribute has " + std::to_string(typed.count) + " values for " + std::to_string(vertices_) +
                    " vertices",
                place);
  }
  const auto type = static_cast<ComponentType>(typed.componentType);
  budget_.add_bytes(typed.count * components * size_of(type), place);
  const Json* id = draco_ids_ && compressed ? find(*draco_ids_, name) : nullptr;
  if (!id) return accessors_.attribute(accessor, name);
  const JsonReader reader(document_.json);
  const auto unique_id = static_cast<std::uint32_t>(reader.required_integer(*draco_ids_, name, 0xffffffff));
  return Attribute{name, type, typed.normalized, components, compressed->values(unique_id, type, components)};
}

std::vector<std::uint32_t> PrimitiveReader::read_indices(const tinygltf::Primitive& primitive, std::size_t vertices) {
  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    const auto accessor = static_cast<std::size_t>(primitive.indices);
    // A strip has one triangle less than this bound times three.
    budget_.add_bytes(accessors_.accessor(accessor).count * sizeof(std::uint32_t), where("/indices"));
    indices = accessors_.indices(accessor);
  } else {
    indices.resize(vertices);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < vertices) continue;
    throw Error(ErrorCode::malformed,
                "index " + std::to_string(i) + " is " + std::to_string(indices[i]) + ", but there are only " +
                    std::to_string(vertices) + " vertices",
                where("/indices"));
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0) {
    note("incomplete-triangle", "the number of indices is not a multiple of 3; those left over are dropped", where());
  }
  return triangle_list(std::move(indices), primitive.mode);
}

} // namespace

void check_positions(const Primitive& primitive) {
  const Attribute* position = primitive.find("POSITION");
  if (!position || position->type != ComponentType::f32) return;
  for (std::size_t v = 0; v < position->count(); ++v) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double value = position->get(v, c);
      if (std::isfinite(value)) continue;
      throw Error(ErrorCode::invalid_geometry,
                  "vertex " + std::to_string(v) + " of mesh " + std::to_string(primitive.mesh) + ", primitive " +
                      std::to_string(primitive.primitive) + " has a coordinate that is " +
                      (std::isnan(value) ? "not a number" : "infinite") + "; repair the mesh and send it again",
                  "/meshes/" + std::to_string(primitive.mesh) + "/primitives/" + std::to_string(primitive.primitive) +
                      "/attributes/POSITION");
    }
  }
}

std::vector<Primitive> read_primitives(const Document& document, const Limits& limits,
                                       std::vector<Asset::Note>& notes) {
  const tinygltf::Model model = typed_model(document.json);
  PrimitiveReader reader(document, model, limits, notes);
  std::vector<Primitive> out;
  for (std::uint32_t m = 0; m < model.meshes.size(); ++m) {
    for (std::uint32_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
      auto primitive = reader.read(m, p);
      if (!primitive) continue;
      if (!primitive->indices.empty()) out.push_back(std::move(*primitive));
    }
  }
  return out;
}

} // namespace orbis::asset
