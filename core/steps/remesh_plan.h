// Which components are remeshed, and how finely: known from the surface alone, before it is on its sphere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/options.h"
#include "core/report.h"
#include "core/steps/surface.h"

namespace orbis {

struct RemeshPlan {
  std::vector<std::uint32_t> times; // by component: how often its polyhedron is divided; 0: it keeps its triangles
  std::vector<Note> kept;           // why some do
};

// target: of the component with the largest area; the others get triangles of about its size. A component that has caps
// (its sphere is not all surface) or several primitives keeps its triangles. Nothing is planned for a target without a
// base. Throws Error: not_genus_zero where no component can be remeshed, too_large where the triangles would be more
// than the limits allow.
[[nodiscard]] RemeshPlan plan_remesh(const Surface& surface, const RemeshTarget& target, const Limits& limits);

} // namespace orbis
