// A raw Draco file as an asset: a document with one node and one mesh is made around it.
#pragma once

#include <span>

#include "core/asset/asset.h"

namespace orbis::asset {

// Throws what DracoMesh throws, and Error{invalid_geometry} where it has no positions.
[[nodiscard]] Asset read_draco_file(std::span<const std::byte> bytes, const Limits& limits);

} // namespace orbis::asset
