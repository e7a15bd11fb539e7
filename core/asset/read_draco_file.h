// A raw Draco file as a glTF with one node and one mesh.
#pragma once

#include <span>

#include "core/asset/model_builder.h"

namespace orbis::asset {

// Colours of 8 bits are taken for sRGB and become linear, as glTF has them; others are linear already. Throws what
// DracoMesh throws, and Error{invalid_geometry} where it has no positions.
[[nodiscard]] Converted read_draco_file(std::span<const std::byte> bytes, const Limits& limits);

} // namespace orbis::asset
