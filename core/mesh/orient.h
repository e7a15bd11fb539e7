// One side for every triangle, neighbour by neighbour.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/gluing.h"

namespace orbis::mesh {

struct Orientation {
  std::vector<bool> turned;    // by triangle
  std::uint64_t cut_edges = 0; // unglued, since the surface has only one side (a Moebius strip lies in it)
};

// Turns triangles (corners 1 and 2 change places) so that all glued half-edges run in opposite directions. A piece that
// agrees with itself stays as it is, even inside out; else a closed piece comes out with a positive volume, and of an
// open one as few triangles as possible are turned. Where no turn helps, edges are unglued until one does. positions:
// of the points.
[[nodiscard]] Orientation orient(std::span<const Vec3f> positions, Gluing& gluing);

} // namespace orbis::mesh
