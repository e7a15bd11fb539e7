// An open component as one chart: its outline becomes the sides of a rectangle, and nothing is cut.
#pragma once

#include <optional>

#include "core/texture/flat_charts.h"
#include "core/texture/outline.h"

namespace orbis::texture {

// One chart of a square, the outline (outline.h) on its sides, by length; the points inside are still to be laid out,
// from a guess that may fold.
// Holes but the longest stay closed. Edges that join two points of one side without running along it have a point of
// their own in their middle, since they could not be laid out else; so has an outline of three edges, as its fourth
// corner.
//
// corners: of the rectangle, on the outline; 0 1 2 3 where it has three vertices. Nothing where a point in the middle
// of an edge would fold a triangle on the sphere. Deterministic; O(triangles).
[[nodiscard]] std::optional<FlatCharts> cut_to_disk(const AtlasComponent& component, const Disk& disk,
                                                    const Corners& corners);

} // namespace orbis::texture
