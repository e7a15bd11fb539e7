// From the spheres to a cut, certified-to-be atlas: deliverable numbers, cut.
#pragma once

#include <vector>

#include "core/report.h"
#include "core/sphere/orientation.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {

struct CutSphere {
  std::vector<sphere::GridPoint> points; // one per vertex of the surface
  texture::CutMesh cut;                  // of all components; without the caps
};

// Snaps each component's points to the grid and cuts its triangles at the atlas' borders. Where rounding folds a
// triangle or a piece beyond repair, the sphere is turned a little against grid and cube and both are tried again, a
// few times, always in the same way. Throws Error{not_certified} if no turn helps.
[[nodiscard]] CutSphere snap_and_cut(const Surface& surface, std::span<const Vec3d> points,
                                     const texture::AtlasLayout& layout, Progress& progress, Report& report);

} // namespace orbis
