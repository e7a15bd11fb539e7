// An indexed triangle mesh as flat arrays: what crosses the borders between the parts of core.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace orbis::mesh {

using Index = std::uint32_t;
using Triangle = std::array<Index, 3>; // counter-clockwise seen from outside

struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles; // indices into positions
};

} // namespace orbis::mesh
