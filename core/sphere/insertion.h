// A vertex put back into the hole that its removal left: a point in the kernel of a polygon on the sphere.
#pragma once

#include <optional>
#include <span>

#include "core/vec3.h"

namespace orbis::sphere {

// A point that sees the whole polygon: det(point, polygon[k], polygon[k + 1]) > 0 for all k.
//   polygon  counter-clockwise, in the sphere's order; polygon[0] sees all edges that do not touch it (its fan is
//            positively oriented), so a point close enough to it in the wedge of its two neighbours always exists
// Tries the middle of the polygon first, then walks towards polygon[0] by halves. Nothing where doubles cannot tell the
// point from polygon[0] any more.
[[nodiscard]] std::optional<Vec3d> point_in_kernel(std::span<const Vec3d> polygon);

} // namespace orbis::sphere
