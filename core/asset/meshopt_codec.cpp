#include "core/asset/meshopt_codec.h"

#include <meshoptimizer.h>

#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

// The library asserts what is checked here.
bool sizes_fit(const MeshoptView& view) {
  if (view.count == 0) return false;
  if (view.mode == "ATTRIBUTES") return view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0;
  const bool is_index = view.stride == 2 || view.stride == 4;
  return is_index && (view.mode == "INDICES" || view.count % 3 == 0);
}

bool filter_fits(const MeshoptView& view) {
  if (view.filter == "NONE") return true;
  if (view.mode != "ATTRIBUTES") return false;
  if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8;
  if (view.filter == "QUATERNION") return view.stride == 8;
  return true; // exponential: any multiple of 4
}

int decode(Bytes& out, std::span<const std::byte> data, const MeshoptView& view) {
  const auto* source = reinterpret_cast<const unsigned char*>(data.data());
  if (view.mode == "ATTRIBUTES") {
    return meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, source, data.size());
  }
  if (view.mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, source, data.size());
  }
  return meshopt_decodeIndexSequence(out.data(), view.count, view.stride, source, data.size());
}

void apply_filter(Bytes& bytes, const MeshoptView& view) {
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
}

// The first byte is a kind and, in its lower half, a version: vertices 0xa0, triangles 0xe0 and 0xe1, sequences 0xd0
// and 0xd1. What follows these versions may be valid and still unknown to the library.
bool is_newer(std::span<const std::byte> data, const MeshoptView& view) {
  if (data.empty()) return false;
  const auto head = std::to_integer<unsigned>(data[0]);
  const unsigned kind = view.mode == "ATTRIBUTES" ? 0xa0u : view.mode == "TRIANGLES" ? 0xe0u : 0xd0u;
  return (head & 0xf0u) == kind && (head & 0x0fu) > (view.mode == "ATTRIBUTES" ? 0u : 1u);
}

} // namespace

Bytes decode_meshopt(std::span<const std::byte> data, const MeshoptView& view, const std::string& where) {
  if (view.mode != "ATTRIBUTES" && view.mode != "TRIANGLES" && view.mode != "INDICES") {
    throw Error(ErrorCode::unsupported_feature, "the meshopt mode '" + shown(view.mode) + "' is not known", where);
  }
  if (view.filter != "NONE" && view.filter != "OCTAHEDRAL" && view.filter != "QUATERNION" &&
      view.filter != "EXPONENTIAL") {
    throw Error(ErrorCode::unsupported_feature, "the meshopt filter '" + shown(view.filter) + "' is not known", where);
  }
  if (!sizes_fit(view) || !filter_fits(view)) {
    throw Error(ErrorCode::malformed, "the count, byteStride or filter does not fit the meshopt mode", where);
  }
  Bytes out(view.count * view.stride);
  if (decode(out, data, view) != 0) {
    if (is_newer(data, view)) {
      throw Error(ErrorCode::unsupported_feature,
                  "the view is stored in a newer version of the meshopt format than is understood; export it without "
                  "compression, or with EXT_meshopt_compression",
                  where);
    }
    throw Error(ErrorCode::malformed, "the meshopt data is damaged", where);
  }
  apply_filter(out, view);
  return out;
}

Bytes encode_meshopt_vertices(std::span<const std::byte> bytes, std::size_t stride) {
  const std::size_t count = bytes.size() / stride;
  meshopt_encodeVertexVersion(0);
  Bytes out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), bytes.data(), count,
                                        stride));
  if (out.empty()) throw Error(ErrorCode::internal, "vertices could not be encoded with meshopt");
  return out;
}

Bytes encode_meshopt_triangles(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  meshopt_encodeIndexVersion(1);
  Bytes out(meshopt_encodeIndexBufferBound(indices.size(), vertex_count));
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), indices.data(),
                                       indices.size()));
  if (out.empty()) throw Error(ErrorCode::internal, "triangles could not be encoded with meshopt");
  return out;
}

} // namespace orbis::asset
