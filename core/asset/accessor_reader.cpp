#include "core/asset/accessor_reader.h"

#include <cstring>

namespace orbis::asset {
namespace {

std::string where_of(std::size_t accessor) { return "/accessors/" + std::to_string(accessor); }

std::size_t element_size_of(const tinygltf::Accessor& accessor) {
  return static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type))) *
         size_of(static_cast<ComponentType>(accessor.componentType));
}

std::uint32_t load_index(std::span<const std::byte> data, std::size_t i, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t b = 0; b < size; ++b) value |= std::to_integer<std::uint32_t>(data[i * size + b]) << (8 * b);
  return value;
}

} // namespace

// check_document has compared the accessors with the views, and load_document the views with the data.
std::span<const std::byte> AccessorReader::part(int view, std::size_t offset, std::size_t size) const {
  const auto bytes = document_.view(static_cast<std::size_t>(view));
  if (offset > bytes.size() || size > bytes.size() - offset) {
    throw Error(ErrorCode::internal, "an accessor leaves its checked buffer view");
  }
  return bytes.subspan(offset, size);
}

Bytes AccessorReader::packed(std::size_t i) const {
  const tinygltf::Accessor& a = accessor(i);
  const std::size_t size = element_size_of(a);
  Bytes out(a.count * size);
  if (has_no_view(model_, a)) return out;
  const std::size_t declared = model_.bufferViews.at(static_cast<std::size_t>(a.bufferView)).byteStride;
  const std::size_t stride = declared == 0 ? size : declared;
  const auto in = part(a.bufferView, a.byteOffset, (a.count - 1) * stride + size);
  if (stride == size) {
    std::memcpy(out.data(), in.data(), out.size());
  } else {
    for (std::size_t v = 0; v < a.count; ++v) std::memcpy(out.data() + v * size, in.data() + v * stride, size);
  }
  return out;
}

void AccessorReader::apply_sparse(std::size_t i, Bytes& out) const {
  const tinygltf::Accessor& a = accessor(i);
  if (!a.sparse.isSparse) return;
  const auto count = static_cast<std::size_t>(a.sparse.count);
  const std::size_t size = element_size_of(a);
  const std::size_t index_size = size_of(static_cast<ComponentType>(a.sparse.indices.componentType));
  const auto indices =
      part(a.sparse.indices.bufferView, static_cast<std::size_t>(a.sparse.indices.byteOffset), count * index_size);
  const auto values =
      part(a.sparse.values.bufferView, static_cast<std::size_t>(a.sparse.values.byteOffset), count * size);
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t index = load_index(indices, k, index_size);
    if (index >= a.count || (k > 0 && index <= previous)) {
      throw Error(ErrorCode::malformed, "the sparse indices must increase and stay below the accessor's count",
                  where_of(i) + "/sparse/indices");
    }
    previous = index;
    std::memcpy(out.data() + index * size, values.data() + k * size, size);
  }
}

Attribute AccessorReader::attribute(std::size_t i, const std::string& name) const {
  const tinygltf::Accessor& a = accessor(i);
  Attribute out{name, static_cast<ComponentType>(a.componentType), a.normalized,
                static_cast<std::uint32_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type))),
                packed(i)};
  apply_sparse(i, out.data);
  return out;
}

std::vector<std::uint32_t> AccessorReader::indices(std::size_t i) const {
  const tinygltf::Accessor& a = accessor(i);
  const auto type = static_cast<ComponentType>(a.componentType);
  const bool is_unsigned = type == ComponentType::u8 || type == ComponentType::u16 || type == ComponentType::u32;
  if (a.type != TINYGLTF_TYPE_SCALAR || !is_unsigned || a.normalized) {
    throw Error(ErrorCode::malformed, "indices must be SCALAR of an unsigned integer type", where_of(i));
  }
  Bytes data = packed(i);
  apply_sparse(i, data);
  std::vector<std::uint32_t> out(a.count);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = load_index(data, k, size_of(type));
  return out;
}

} // namespace orbis::asset
