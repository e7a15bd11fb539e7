// Components that are left out of a level, the smallest first.
#pragma once

#include <cstdint>

#include "core/lod/wedge_mesh.h"

namespace orbis::lod {

struct Dropped {
  std::uint64_t components = 0, triangles = 0;
  double largest = 0; // the diagonal of the largest one's bounding box, as a fraction of the model's
};

// Takes the components with the smallest area away, one after the other, until `mesh` has no more than `triangles` of
// them; only those whose bounding box has a diagonal below `below`, and never the last one. O(n log n).
Dropped drop_components(WedgeMesh& mesh, std::uint64_t triangles, double below);

} // namespace orbis::lod
