// Which way the sphere lies: turned so that its directions are the model's.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::sphere {

// The points turned, without any other change, so that they agree best with the directions in which their vertices lie:
// the rotation R that minimises sum a_v |R s_v - d_v|^2, with a_v the vertex' share of the surface's area and d_v its
// position relative to the area's centroid (Kabsch 1976, Wahba's problem). So the +X face of a cube map covers the
// model's +X side, and similar models in the same pose get similar maps. Where no rotation is best (a surface without
// preferred directions) the points are returned as they are.
[[nodiscard]] std::vector<Vec3d> canonically_turned(const mesh::TriangleMesh& mesh, std::vector<Vec3d> points);

} // namespace orbis::sphere
