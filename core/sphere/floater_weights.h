// Shape-preserving weights: M. S. Floater, "Parametrization and smooth approximation of surface triangulations",
// Computer Aided Geometric Design 14 (1997), section 6.
#pragma once

#include <span>
#include <vector>

#include "core/vec3.h"

namespace orbis::sphere {

// The weights of a vertex's ring that reproduce the shape of its star.
//   centre  position of the vertex
//   ring    positions of its neighbours in cyclic order, three or more, closed (the last is next to the first)
// Returns one weight per neighbour: all positive and finite, of sum 1, and such that the centre of the flattened star
// is the weighted mean of its flattened ring. Lengths may have any unit, but their squares must not overflow.
// A degenerate star (a zero edge, a zero angle, a fold onto itself) counts as the nearest star that is just not
// degenerate; a star that shrinks to one point gets equal weights.
[[nodiscard]] std::vector<double> floater_weights(const Vec3d& centre, std::span<const Vec3d> ring);

} // namespace orbis::sphere
