// The surface cut along the borders of the cube's faces.
#pragma once

#include "core/texture/flat_charts.h"

namespace orbis::texture {

// One chart for each face of the cube that the component has triangles in. Vertices of the result are shared where
// point, chart and input vertices agree. Flat coordinates are those of the central projection, exactly 0 or 1 for the
// points of the chart's boundary; sizes are not set.
//
// No T-junctions: a crossing on an edge is one point, shared by both triangles, exactly on the border's plane. All
// pieces are positively oriented on the sphere (exactly), else Error{not_certified}: turning the sphere a little
// against the cube then helps. A vertex within 2^-18 of a border counts as on it, so that pieces never degenerate.
// Deterministic; O(triangles). Reports Stage::atlas, throws Error{canceled}.
[[nodiscard]] FlatCharts cut(const AtlasComponent& component, Progress& progress);

} // namespace orbis::texture
