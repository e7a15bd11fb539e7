// Folds that a warp left in a flat mesh, taken out again.
#pragma once

#include "core/texture/plane_energy.h"

namespace orbis::texture {

// Moves the corners of folded and of very thin triangles to where their whole star is positive, as far as there is such
// a place: a few rounds over them. Returns whether no fold is left; a mesh without one never gets one. Only points near
// folds move; those on a side stay on it.
[[nodiscard]] bool untangle(PlaneMesh& mesh);

} // namespace orbis::texture
