// A disk that closes a boundary loop for the parametrization.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

struct Cap {
  std::vector<Vec3f> positions;    // of the vertices that are added
  std::vector<Triangle> triangles; // 0 .. n - 1: the loop's vertices; from n on: those added
};

// loop: the positions along it, n >= 3, in the direction of the open half-edges; the cap's triangles run against it.
//
// Short loops get a fan around their centroid. Longer ones first get rings of half as many vertices each, as far apart
// as their vertices are, so that triangles are well shaped and no vertex has a valence above 9: a fan of a thousand
// triangles would be a thousand needles. The cap is what would be there if the hole were filled flat: the cap of a flat
// disk is its mirror image, so that the disk takes one hemisphere; holes small against the surface stay small.
[[nodiscard]] Cap make_cap(std::span<const Vec3f> loop);

} // namespace orbis::mesh
