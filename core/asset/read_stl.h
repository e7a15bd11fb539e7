// Stereolithography files (3D Systems, 1989), binary and textual.
#pragma once

#include "core/asset/model_builder.h"

namespace orbis::asset {

// Triangles only; the corners at one position become one vertex, since the format repeats each corner for every
// triangle and has nothing else to tell them apart. Facet normals and the two attribute bytes are left out. Each
// "solid" of a textual file becomes a mesh. Throws Error{malformed, too_large}.
[[nodiscard]] Converted read_stl(std::span<const std::byte> bytes, const Limits& limits);

} // namespace orbis::asset
