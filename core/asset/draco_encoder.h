// KHR_draco_mesh_compression without loss, through libdraco's encoder.
#pragma once

#include <cstdint>
#include <span>

#include "core/asset/asset.h"

namespace orbis::asset {

// Sequential encoding, nothing quantised: vertices keep their order (morph targets outside rely on it) and every value
// its bits; what is saved is the connectivity and the integers. Attribute i of the primitive gets the unique id i.
// Expects can_be_draco.
[[nodiscard]] Bytes encode_draco(std::span<const std::uint32_t> indices, std::span<const Attribute> attributes);

// False for what Draco's sequential encoding cannot hold: more vertices than the triangles have corners (its decoder
// takes that for damage), or integers above 2^31.
[[nodiscard]] bool can_be_draco(std::span<const std::uint32_t> indices, std::span<const Attribute> attributes);

} // namespace orbis::asset
