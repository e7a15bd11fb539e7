#include "core/asset/draco_encoder.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>

namespace orbis::asset {
namespace {

draco::DataType data_type(ComponentType type) {
  switch (type) {
  case ComponentType::i8:
    return draco::DT_INT8;
  case ComponentType::u8:
    return draco::DT_UINT8;
  case ComponentType::i16:
    return draco::DT_INT16;
  case ComponentType::u16:
    return draco::DT_UINT16;
  case ComponentType::u32:
    return draco::DT_UINT32;
  case ComponentType::f32:
    return draco::DT_FLOAT32;
  }
  return draco::DT_INVALID;
}

draco::GeometryAttribute::Type attribute_type(std::string_view name) {
  if (name == "POSITION") return draco::GeometryAttribute::POSITION;
  if (name == "NORMAL") return draco::GeometryAttribute::NORMAL;
  if (name.substr(0, 9) == "TEXCOORD_") return draco::GeometryAttribute::TEX_COORD;
  if (name.substr(0, 6) == "COLOR_") return draco::GeometryAttribute::COLOR;
  return draco::GeometryAttribute::GENERIC;
}

void add_attribute(draco::Mesh& mesh, const Attribute& attribute, std::uint32_t id) {
  const std::size_t width = attribute.components * size_of(attribute.type);
  draco::GeometryAttribute layout;
  layout.Init(attribute_type(attribute.name), nullptr, static_cast<std::uint8_t>(attribute.components),
              data_type(attribute.type), attribute.normalized, static_cast<std::int64_t>(width), 0);
  const int place = mesh.AddAttribute(layout, true, static_cast<std::uint32_t>(attribute.count()));
  draco::PointAttribute& added = *mesh.attribute(place);
  added.set_unique_id(id);
  added.buffer()->Write(0, attribute.data.data(), attribute.data.size());
}

} // namespace

bool can_be_draco(std::span<const std::uint32_t> indices, std::span<const Attribute> attributes) {
  return attributes.front().count() <= indices.size() &&
         std::none_of(attributes.begin(), attributes.end(),
                      [](const Attribute& attribute) { return attribute.type == ComponentType::u32; });
}

Bytes encode_draco(std::span<const std::uint32_t> indices, std::span<const Attribute> attributes) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(attributes.front().count()));
  mesh.SetNumFaces(indices.size() / 3);
  for (std::uint32_t f = 0; f < indices.size() / 3; ++f) {
    mesh.SetFace(draco::FaceIndex(f), {draco::PointIndex(indices[3 * f]), draco::PointIndex(indices[3 * f + 1]),
                                       draco::PointIndex(indices[3 * f + 2])});
  }
  for (std::uint32_t i = 0; i < attributes.size(); ++i) add_attribute(mesh, attributes[i], i);

  auto options = draco::EncoderOptionsBase<draco::GeometryAttribute::Type>::CreateDefaultOptions();
  options.SetGlobalBool("compress_connectivity", true);
  draco::Encoder encoder;
  encoder.Reset(options);
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) {
    throw Error(ErrorCode::internal, "the primitive could not be encoded with Draco");
  }
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

} // namespace orbis::asset
