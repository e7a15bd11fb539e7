// Rounding to the grid can fold a piece that is only a few grid steps wide: then a neighbouring grid point will do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/orientation.h"
#include "core/texture/cube_map.h"

namespace orbis::texture {

// A point that the cut added: a crossing, which may slide along its border, or a corner of the cube, which may not.
struct AddedPoint {
  sphere::GridPoint sphere{};
  Face from = 0, to = 0; // the border's two faces; equal for a corner of the cube
};

// Moves crossings to neighbouring grid points of their borders until every piece is positively oriented. pieces:
// indices of points, given ones first (0 .. sphere.size() - 1), then added ones. Throws Error{not_certified} where that
// fails.
void unfold(std::span<const mesh::Triangle> pieces, std::span<const sphere::GridPoint> sphere,
            std::vector<AddedPoint>& added);

} // namespace orbis::texture
