// Which faces of the cube a point lies in, and where an edge crosses from one to the next.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sphere/orientation.h"
#include "core/texture/cube_map.h"

namespace orbis::texture {

// A set of faces: bit f for face f.
using FaceMask = std::uint8_t;
constexpr FaceMask bit_of(Face f) { return static_cast<FaceMask>(1U << f); }

// A point this close to a border (2^-18, in grid units) lies in the faces on both sides of it.
inline constexpr std::int32_t border_tolerance = 1 << (sphere::grid_bits - 18);

// The faces that p lies in: one inside a face, two on a border, three at a corner of the cube.
[[nodiscard]] FaceMask faces_at(const sphere::GridPoint& p);

struct BorderCrossing {
  double t = 0;             // the point is (1 - t) a + t b, normalized
  sphere::GridPoint sphere; // exactly on the plane of the border: equal coordinates along `from` and `to`
  Face from = 0, to = 0;    // the faces on the two sides, in the direction from a to b
  FaceMask faces = 0;       // both of them, and a third within the tolerance of a corner
};

// The points at which the arc from a to b must be cut so that each part lies in one face, in order from a to b. None
// where a and b share a face. a and b: not antipodal.
[[nodiscard]] std::vector<BorderCrossing> border_crossings(const sphere::GridPoint& a, const sphere::GridPoint& b);

} // namespace orbis::texture
