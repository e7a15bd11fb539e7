// A disk laid into a convex outline.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/texture/flat_charts.h"
#include "core/texture/plane_energy.h"

namespace orbis::texture {

// Moves the points that are not on a side to where each is a weighted mean of its neighbours: with positive weights no
// triangle is folded (Tutte, How to draw a graph, 1963; Floater, Parametrization and smooth approximation of surface
// triangulations, 1997), where the outline is convex and no edge joins two points of one side but along it. The weights
// are the cotangents of the opposite angles (Pinkall and Polthier 1993) where these are positive enough, so that shapes
// are kept about as they are.
//
// mesh: points on its sides are fixed in x or y, and none else is; the places of the others are a guess, used only for
// speed: what is close to what. Returns false where the numbers do not suffice. Deterministic; about O(points).
[[nodiscard]] bool lay_harmonically(PlaneMesh& mesh);

} // namespace orbis::texture
