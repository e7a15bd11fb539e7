// EXT_meshopt_compression and KHR_meshopt_compression, through libmeshoptimizer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/asset/asset.h"

namespace orbis::asset {

struct MeshoptView {
  std::size_t count = 0, stride = 0; // elements, and bytes of one
  std::string mode;                  // "ATTRIBUTES", "TRIANGLES", "INDICES"
  std::string filter = "NONE";       // "NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"
};

// The decoded view: count * stride bytes, which the caller has held against its limits. Indices may be out of range:
// who reads them checks. `where` is the view's JSON pointer. Throws Error: malformed where the data or the sizes are
// not what the mode allows; unsupported_feature for a mode, filter or version of the format that is not known.
[[nodiscard]] Bytes decode_meshopt(std::span<const std::byte> data, const MeshoptView& view, const std::string& where);

// The same without a filter, version 0 of the vertex format and 1 of the index format, as EXT_meshopt_compression has
// them. stride: a multiple of 4 up to 256; bytes: whole vertices, at least one.
[[nodiscard]] Bytes encode_meshopt_vertices(std::span<const std::byte> bytes, std::size_t stride);
// Triangles keep their order and their orientation, but may begin with another corner.
[[nodiscard]] Bytes encode_meshopt_triangles(std::span<const std::uint32_t> indices, std::size_t vertex_count);

} // namespace orbis::asset
