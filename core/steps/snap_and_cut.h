// From the spheres to a cut, certified-to-be atlas: deliverable numbers, cut.
#pragma once

#include <vector>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/sphere/orientation.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {

struct CutSphere {
  std::vector<sphere::GridPoint> points; // one per vertex of the surface
  texture::CutMesh cut;                  // of all components; without the caps
};

// Snaps each component's points to the grid, cuts it into charts and packs them all into pages, by options.atlas and
// options.texture_size. Where rounding folds a triangle or a piece beyond repair, that component's sphere is turned a
// little against grid and cube and tried again, a few times, always in the same way; if no turn helps, the component is
// left out of the surface, as leave_out says. points: one per vertex of the surface. Fills report.atlas but for its
// source.
[[nodiscard]] CutSphere snap_and_cut(const asset::Asset& asset, Surface& surface, std::vector<Vec3d>& points,
                                     const Options& options, Progress& progress, Report& report);

} // namespace orbis
