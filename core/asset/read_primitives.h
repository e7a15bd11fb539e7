// The triangle primitives of a document as typed arrays.
#pragma once

#include <vector>

#include "core/asset/document.h"

namespace orbis::asset {

// Reads every primitive of mode 4, 5 or 6; points and lines are passed over. Adds to `notes`. Throws Error: malformed
// (attributes of different sizes or of the wrong type, indices out of range), too_large, invalid_geometry (positions
// that are not finite), and what the decoders throw.
[[nodiscard]] std::vector<Primitive> read_primitives(const Document& document, const Limits& limits,
                                                     std::vector<Asset::Note>& notes);

// Throws Error{invalid_geometry} that names the first vertex with a coordinate that is NaN or infinite.
void check_positions(const Primitive& primitive);

} // namespace orbis::asset
