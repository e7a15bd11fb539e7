// A semi-regular triangulation in place of the input's triangles: a subdivided polyhedron, sampled through the sphere.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/progress.h"
#include "core/report.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {

// What was there before: the maps are baked from it.
struct RemeshSource {
  asset::Asset asset;
  Surface surface;
  std::vector<Vec3d> points; // one per vertex of the surface
};

// Replaces each component that allows it by the polyhedron, its vertices taken from the surface
// where the sphere map has them, with every attribute interpolated; asset, surface and points are then as if the model
// had come that way, and what follows need not know. Returns what they were; nothing, and changes nothing, where the
// target has no base. target: of the component with the largest area.
//
// Which components, and how finely: plan_remesh (core/steps/remesh_plan.h), whose errors it throws; why others stay as
// they are is noted. Triangles that only ride on a remeshed component are gone. Fills report.remesh.
[[nodiscard]] std::optional<RemeshSource> resample(asset::Asset& asset, Surface& surface, std::vector<Vec3d>& points,
                                                   const RemeshTarget& target, const Limits& limits, Progress& progress,
                                                   Report& report);

// The source's surface laid into the remesh's atlas (core/remesh/overlay.h), to bake from. surface, points: of the
// remesh, as `cut` was made from them.
[[nodiscard]] texture::CutMesh source_in_atlas(const RemeshSource& source, const Surface& surface,
                                               std::span<const Vec3d> points, const texture::CutMesh& cut,
                                               std::uint32_t threads);

} // namespace orbis
