// Vertex attributes at new vertices: what the three corners say, blended the way each attribute's meaning asks for.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/asset/asset.h"

namespace orbis {

// A vertex of the output: a copy of an input vertex where one weight is 1, else a blend.
struct VertexSource {
  std::array<std::uint32_t, 3> corners; // vertices of the primitive
  std::array<double, 3> weights;        // not negative, sum 1

  // The corner that is copied, or -1 for a blend.
  [[nodiscard]] int copied() const;
};

// The attributes at `sources`, one output vertex each.
//
// Copied vertices keep their bits. POSITION, TEXCOORD_n and COLOR_n are blended linearly; NORMAL and TANGENT.xyz are
// brought back to unit length; TANGENT.w is that of the nearest corner; JOINTS_n and WEIGHTS_n are merged, the
// strongest influences kept and their weights brought to sum 1; integer attributes without normalisation are taken from
// the nearest corner. Integer positions become floats of the same value, since a point on an edge has no integer
// coordinates.
[[nodiscard]] std::vector<asset::Attribute> interpolate(std::span<const asset::Attribute> attributes,
                                                        std::span<const VertexSource> sources);

// The same for the attributes of a morph target: differences, which are blended linearly whatever their name.
[[nodiscard]] std::vector<asset::Attribute> interpolate_target(std::span<const asset::Attribute> attributes,
                                                               std::span<const VertexSource> sources);

} // namespace orbis
