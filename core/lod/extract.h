// A level of detail, taken out of the mesh under simplification.
#pragma once

#include "core/lod/simplify.h"
#include "core/lod/wedge_mesh.h"

namespace orbis::lod {

// Points and vertices are numbered in the order of the triangles, which is that of the full surface.
[[nodiscard]] Level extract(const FullSurface& full, const WedgeMesh& mesh);

// By region of the full surface: one of the level's triangles in it, or `none`.
[[nodiscard]] std::vector<std::uint32_t> first_of_regions(const FullSurface& full, const Level& level);

} // namespace orbis::lod
