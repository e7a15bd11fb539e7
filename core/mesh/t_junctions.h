// Vertices that lie on another sheet's edge: the crack between the two closed for the parametrization.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/gluing.h"

namespace orbis::mesh {

// Where two open edges leave a point in the same direction, one of them longer than the other, the shorter one's end
// lies on the longer one: a T-junction. A triangle without area is put between them (point, longer end, shorter end),
// and the crack goes on with its third side, until it is closed. The triangles that are added stand behind the others.
//   tolerance  distance of a vertex from the edge, in units of the positions; rounding (a millionth of the edge) is
//              always allowed for
// Returns how many triangles were added. Requires an oriented gluing.
[[nodiscard]] std::uint64_t close_t_junctions(std::span<const Vec3f> positions, double tolerance, Gluing& gluing);

} // namespace orbis::mesh
