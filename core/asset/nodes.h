// What a node of the document says of itself.
#pragma once

#include "core/asset/json.h"
#include "core/asset/placement.h"

namespace orbis::asset {

// A node's own transform: its matrix, or its translation, rotation and scale. Throws Error{malformed} where these are
// not lists of the right length.
[[nodiscard]] Placement local_placement(const JsonReader& reader, const Json& node);

} // namespace orbis::asset
