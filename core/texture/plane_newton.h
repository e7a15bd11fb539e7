// The energy of a flat map lowered for all of its points at once.
#pragma once

#include "core/texture/plane_energy.h"

namespace orbis::texture {

// Newton's method over the whole mesh, with the Hessian of each triangle made positive semi-definite (Teran et al.
// 2005) and steps that fold nothing, each after a few sweeps over single points (relax): those undo what would hold the
// whole back, thin triangles about to fold; the steps move what sweeps come to slowly. Points on a side slide along it,
// and the right and the lower side move as a whole. All triangles must be positive, and stay so. Ends where a round
// gains less than a thousandth, or after 200 rounds; 20 on a mesh of more than 10,000 triangles. Deterministic.
void lower_by_newton(PlaneMesh& mesh);

} // namespace orbis::texture
