// EXT_meshopt_compression and KHR_meshopt_compression, through libmeshoptimizer.
#pragma once

#include <cstddef>
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

} // namespace orbis::asset
