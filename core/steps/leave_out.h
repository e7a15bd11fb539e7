// Components that could not be parametrized, while the others go on.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/report.h"
#include "core/steps/surface.h"

namespace orbis {

// Component of the surface -> why it has no parametrization.
using Problems = std::map<std::uint32_t, Note>;

// Takes the components out of the surface, and their vertices out of `points` (one per vertex, or none at all): their
// triangles are riders from here on, without a place on any sphere. Writes the problems to the report and marks it
// partial. Throws Error{not_certified} with the first problem where no component is left.
void leave_out(const Problems& problems, Surface& surface, std::vector<Vec3d>& points, Report& report);

} // namespace orbis
