// Where points go that are not relaxed: the first four, a vertex just split off, and all of them when the sphere is
// turned inside itself to make room on one side. And whether they can be delivered there.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/shape_preserving_star.h"

namespace orbis::sphere {

// A place for a vertex that was just split off its parent, and lies there still.
//   star    the new vertex's star; its centre is the parent's place, which is one of the ring
//   parent, left, right   places in star.ring of the parent and of the two vertices next to both
//   floor   of star_energy
// The parent's place sees its whole star, and so does every point close enough to it in the wedge between right and
// left: candidates go from half the distance to the nearest neighbour towards the parent, halving. Returns the one of
// least energy; its star_energy is infinite only where even double precision has no room.
[[nodiscard]] Vec3d insertion_place(const Star& star, std::size_t parent, std::size_t left, std::size_t right,
                                    double floor);

// A regular tetrahedron on the unit sphere: (0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2) are counter-clockwise from
// outside.
[[nodiscard]] std::array<Vec3d, 4> regular_tetrahedron();

// The Moebius map of the sphere that moves the point a inside the ball to its centre. Conformal: it keeps the shapes of
// small triangles, and gives the side towards a more room.
[[nodiscard]] Vec3d moebius(const Vec3d& x, const Vec3d& a);

// Whether every triangle surely stays positively oriented when its corners are rounded to multiples of 2^-24, as they
// are delivered: V > 2^-22 times the longest edge. Rounding moves a corner p by at most sqrt(3) 2^-25, and V by that
// times |q x r| <= |q - r| for each corner: by less than 2^-22 times the longest edge in all.
[[nodiscard]] bool survives_rounding(std::span<const mesh::Triangle> triangles, std::span<const Vec3d> points);

} // namespace orbis::sphere
