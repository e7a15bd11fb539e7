#include "core/asset/draco_decoder.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include <cstring>
#include <new>
#include <stdexcept>

#include "core/asset/draco_header.h"

namespace orbis::asset {
namespace {

// No real mesh is stored in so few bits: a flat grid, the best case, takes some 60 triangles a byte.
constexpr std::uint64_t most_per_byte = 4096;

std::optional<ComponentType> component_type_of(draco::DataType type) {
  switch (type) {
  case draco::DT_INT8:
    return ComponentType::i8;
  case draco::DT_UINT8:
  case draco::DT_BOOL:
    return ComponentType::u8;
  case draco::DT_INT16:
    return ComponentType::i16;
  case draco::DT_UINT16:
    return ComponentType::u16;
  case draco::DT_UINT32:
    return ComponentType::u32;
  case draco::DT_FLOAT32:
    return ComponentType::f32;
  default:
    return std::nullopt;
  }
}

DracoMesh::Use use_of(draco::GeometryAttribute::Type type) {
  switch (type) {
  case draco::GeometryAttribute::POSITION:
    return DracoMesh::Use::position;
  case draco::GeometryAttribute::NORMAL:
    return DracoMesh::Use::normal;
  case draco::GeometryAttribute::COLOR:
    return DracoMesh::Use::color;
  case draco::GeometryAttribute::TEX_COORD:
    return DracoMesh::Use::texcoord;
  default:
    return DracoMesh::Use::generic;
  }
}

void check_counts(std::uint64_t faces, std::uint64_t vertices, const Limits& limits, const std::string& where) {
  if (faces > limits.max_triangles) {
    throw Error(ErrorCode::too_large,
                "the Draco data has " + std::to_string(faces) + " triangles, more than the limit of " +
                    std::to_string(limits.max_triangles),
                where);
  }
  if (vertices > limits.max_vertices) {
    throw Error(ErrorCode::too_large,
                "the Draco data has " + std::to_string(vertices) + " vertices, more than the limit of " +
                    std::to_string(limits.max_vertices),
                where);
  }
}

void check_header(std::span<const std::byte> bytes, const Limits& limits, const std::string& where) {
  const auto header = read_draco_header(bytes);
  if (!header) throw Error(ErrorCode::malformed, "the Draco data is damaged: its header cannot be read", where);
  if (!header->is_mesh) {
    throw Error(ErrorCode::invalid_geometry,
                "the Draco data is a point cloud; a surface is needed, so encode a mesh with its triangles", where);
  }
  check_counts(header->faces, header->vertices, limits, where);
  if (header->faces + header->vertices > most_per_byte * bytes.size()) {
    throw Error(ErrorCode::malformed,
                "the Draco data is damaged: it claims " + std::to_string(header->faces) + " triangles in " +
                    std::to_string(bytes.size()) + " bytes",
                where);
  }
}

std::unique_ptr<draco::Mesh> decode(std::span<const std::byte> bytes, const std::string& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  try {
    auto result = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (result.ok()) return std::move(result).value();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory,
                "the Draco data needs more memory than there is to decode; it is too large, or damaged", where);
  } catch (const std::length_error&) {
    throw Error(ErrorCode::malformed, "the Draco data is damaged: it has a size that cannot be", where);
  }
  throw Error(ErrorCode::malformed, "the Draco data is damaged or cut short", where);
}

// The decoder does not promise any of this for damaged data.
bool is_consistent(const draco::Mesh& mesh) {
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(f)) {
      if (corner.value() >= mesh.num_points()) return false;
    }
  }
  for (std::int32_t i = 0; i < mesh.num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *mesh.attribute(i);
    const auto size = static_cast<std::int64_t>(attribute.size());
    const std::int64_t width = attribute.num_components() * draco::DataTypeLength(attribute.data_type());
    if (!attribute.buffer() || width <= 0 || attribute.byte_stride() < width || attribute.byte_offset() < 0)
      return false;
    const auto available = static_cast<std::int64_t>(attribute.buffer()->data_size()) - attribute.byte_offset();
    if (size > 0 && (size - 1) * attribute.byte_stride() + width > available) return false;
    if (!attribute.is_mapping_identity() && attribute.indices_map_size() < mesh.num_points()) return false;
    for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
      if (attribute.mapped_index(p).value() >= size) return false;
    }
  }
  return true;
}

template <class T>
bool convert(const draco::PointAttribute& attribute, std::size_t count, std::uint32_t components, Bytes& out) {
  std::vector<T> value(components);
  for (std::size_t v = 0; v < count; ++v) {
    const auto index = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(v)));
    if (!attribute.ConvertValue<T>(index, static_cast<std::int8_t>(components), value.data())) return false;
    std::memcpy(out.data() + v * components * sizeof(T), value.data(), components * sizeof(T));
  }
  return true;
}

bool convert_to(ComponentType type, const draco::PointAttribute& attribute, std::size_t count, std::uint32_t components,
                Bytes& out) {
  switch (type) {
  case ComponentType::i8:
    return convert<std::int8_t>(attribute, count, components, out);
  case ComponentType::u8:
    return convert<std::uint8_t>(attribute, count, components, out);
  case ComponentType::i16:
    return convert<std::int16_t>(attribute, count, components, out);
  case ComponentType::u16:
    return convert<std::uint16_t>(attribute, count, components, out);
  case ComponentType::u32:
    return convert<std::uint32_t>(attribute, count, components, out);
  case ComponentType::f32:
    return convert<float>(attribute, count, components, out);
  }
  return false;
}

} // namespace

bool is_draco(std::span<const std::byte> bytes) {
  return bytes.size() >= 5 && std::memcmp(bytes.data(), "DRACO", 5) == 0;
}

DracoMesh::DracoMesh(std::span<const std::byte> bytes, const Limits& limits, const std::string& where) : where_(where) {
  if (!is_draco(bytes)) throw Error(ErrorCode::malformed, "the data does not begin like Draco", where);
  check_header(bytes, limits, where);
  mesh_ = decode(bytes, where);
  check_counts(mesh_->num_faces(), mesh_->num_points(), limits, where);
  if (!is_consistent(*mesh_)) {
    throw Error(ErrorCode::malformed, "the Draco data is damaged: it refers to vertices that it does not have", where);
  }
}

DracoMesh::~DracoMesh() = default;

std::size_t DracoMesh::vertex_count() const { return mesh_->num_points(); }

std::vector<std::uint32_t> DracoMesh::indices() const {
  std::vector<std::uint32_t> out;
  out.reserve(std::size_t{mesh_->num_faces()} * 3);
  for (draco::FaceIndex f(0); f < mesh_->num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh_->face(f)) out.push_back(corner.value());
  }
  return out;
}

std::vector<DracoMesh::Info> DracoMesh::attributes() const {
  std::vector<Info> out;
  for (std::int32_t i = 0; i < mesh_->num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *mesh_->attribute(i);
    const auto type = component_type_of(attribute.data_type());
    out.push_back({attribute.unique_id(), use_of(attribute.attribute_type()), type.value_or(ComponentType::f32),
                   type.has_value(), attribute.normalized(), static_cast<std::uint32_t>(attribute.num_components())});
  }
  return out;
}

Bytes DracoMesh::values(std::uint32_t id, ComponentType type, std::uint32_t components) const {
  const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
  if (!attribute) {
    throw Error(ErrorCode::malformed, "the Draco data has no attribute " + std::to_string(id), where_);
  }
  if (static_cast<std::uint32_t>(attribute->num_components()) != components) {
    throw Error(ErrorCode::malformed,
                "attribute " + std::to_string(id) + " of the Draco data has " +
                    std::to_string(attribute->num_components()) + " components, not " + std::to_string(components),
                where_);
  }
  const std::size_t count = vertex_count(), width = components * size_of(type);
  Bytes out(count * width);
  if (component_type_of(attribute->data_type()) == type) {
    for (std::size_t v = 0; v < count; ++v) {
      const auto index = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(v)));
      std::memcpy(out.data() + v * width, attribute->GetAddress(index), width);
    }
  } else if (!convert_to(type, *attribute, count, components, out)) {
    throw Error(ErrorCode::malformed,
                "attribute " + std::to_string(id) + " of the Draco data does not fit its accessor", where_);
  }
  return out;
}

} // namespace orbis::asset
