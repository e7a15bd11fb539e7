// How far the maps of all components are from isometries.
#pragma once

#include <span>

#include "core/sphere/distortion.h"
#include "core/steps/surface.h"

namespace orbis {

// Of all triangles, in the square of the positions' unit.
[[nodiscard]] double area_of(const mesh::TriangleMesh& mesh);

// The measures of the delivered triangles, each component scaled to its own part of its sphere. Means are weighted by
// surface area over all components; each component's own go to report.components. points: one per vertex of the
// surface.
[[nodiscard]] sphere::Distortion measure(const Surface& surface, std::span<const Vec3f> points, Report& report);

} // namespace orbis
