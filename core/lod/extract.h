// A level of detail, taken out of the mesh under simplification.
#pragma once

#include "core/lod/simplify.h"
#include "core/lod/wedge_mesh.h"

namespace orbis::lod {

// Points and vertices are numbered in the order of the triangles, which is that of the full surface.
[[nodiscard]] Level extract(const FullSurface& full, const WedgeMesh& mesh);

} // namespace orbis::lod
