// Polygons as triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.h"

namespace orbis::asset {

// More corners than this in one face are refused by the readers: the time grows with their square.
inline constexpr std::size_t max_corners = 2048;

// n - 2 triangles of a simple polygon with n >= 3 corners, flat or nearly so: three places in `corners` each, with the
// polygon's winding. A convex quadrilateral is split along its shorter diagonal, others by cutting off ears (G.
// Meisters, Polygons have ears, 1975) in the projection along their vector area. Where a polygon crosses itself the
// count still holds, the shape is what it is.
[[nodiscard]] std::vector<std::uint32_t> triangulate_polygon(std::span<const Vec3f> corners);

} // namespace orbis::asset
