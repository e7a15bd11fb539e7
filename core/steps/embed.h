// Every component of the surface on a sphere of its own.
#pragma once

#include <vector>

#include "core/checkpoints.h"
#include "core/report.h"
#include "core/steps/surface.h"

namespace orbis {

// The unit vectors of the map in doubles, one per vertex of the surface, by the objective that the options name; each
// sphere is turned to its component's directions. Small components are shared out among the threads, large ones use all
// threads one after the other; the result does not depend on their number. A component that cannot be embedded is left
// out of the surface, as leave_out says. Fills the report's times and "Minimum" (Eq. 3), sums over the components.
// An interrupted run is taken up where `checkpoints` has it: from a level of a large component.
[[nodiscard]] std::vector<Vec3d> embed(Surface& surface, const Options& options, Progress& progress,
                                       Checkpoints& checkpoints, Report& report);

} // namespace orbis
