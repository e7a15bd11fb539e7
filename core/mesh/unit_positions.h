#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

// The mesh's positions in doubles, moved and scaled so that the bounding box starts at the origin and its longest side
// is 1: coordinates from denormals to 3e38 are then safe to square. All zero where the mesh has no extent.
[[nodiscard]] std::vector<Vec3d> unit_positions(const TriangleMesh& mesh);

} // namespace orbis::mesh
