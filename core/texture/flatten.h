// Flat charts brought closer to the surface's own shape and size, each within a rectangle.
#pragma once

#include "core/mesh/thread_pool.h"
#include "core/texture/flat_charts.h"

namespace orbis::texture {

// Where the points of a chart are to begin with: all of them in their places, without a fold, or those on its sides,
// and the others are first laid out between them (harmonic.h).
enum class FlatStart : std::uint8_t { places, outlines };

// charts: as cut() or cut_to_disk() leaves them: every chart a square, its boundary on the square's sides. Moves the
// places so that texels are spread over the surface as evenly as they go (plane_energy.h), with the boundary sliding
// along the sides, and sets the sizes to the rectangles in which that is best. Sides stay straight, so charts stay
// rectangles that nothing can leave, and a triangulation of a rectangle without a fold cannot overlap itself.
//
// position: of each place, in space. Triangles from `delivered` on (by parent) only close holes: they are kept from
// folding, and otherwise shrink. No triangle folds on the way. Throws Error{not_certified} where one cannot be laid out
// at all, because all its corners are on one side: turning the sphere a little then helps. Charts are shared out to the
// pool's threads; the same on any number of them. finish: atlas.h.
void flatten(FlatCharts& charts, std::span<const Vec3d> positions, std::size_t delivered, FlatStart start,
             Finish finish, mesh::ThreadPool& pool);

} // namespace orbis::texture
