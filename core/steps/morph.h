// A second model on the same sphere: what the first one is to become.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "core/steps/delivery.h"
#include "core/steps/remesh.h"

namespace orbis {

// The second model.
struct MorphEnd {
  std::string name; // of the target: that of the file, without its ending
  asset::Asset asset;
  Surface surface; // one component
  std::vector<Vec3d> points;
  Report report; // what is said of it
};

// With options.morph_to: reads that file of the request, which is there (core/check_options.h), and repairs its
// surface. Nothing without the option. `first`: the first model's surface; both must be one closed component of genus 0
// in one primitive, after repair. Throws Error: not_genus_zero that says which model has what, and what reading throws.
[[nodiscard]] std::optional<MorphEnd> read_morph_end(const Request& request, const Limits& limits,
                                                     const Surface& first);

// Maps it to the sphere by the same options as the first model. Fills report.morph but for what is measured later, and
// takes over the notes.
void embed_morph_end(MorphEnd& end, Progress& progress, Report& report);

// The triangulation that both share: options.remesh, or where that is none the icosahedron divided until it has as many
// triangles as the finer model.
[[nodiscard]] RemeshTarget common_target(const Options& options, const Surface& first, const Surface& second);

// Adds the morph target to the first model's remesh (resample): where each of its vertices lies on the second model,
// put where it counts there too. The spheres are laid over each other as the models lie, or with options.features so
// that those meet: by the rotation that does it best, and then by a flow (core/remesh/sphere_flow.h); where that would
// fold triangles, by the rotation alone, which is noted. source: the first model before. surface, points: its remesh.
// Fills report.morph.
void add_morph_target(const MorphEnd& end, const RemeshSource& source, const Surface& surface,
                      std::span<const Vec3d> points, asset::Asset& asset, Progress& progress, Report& report);

// Names the target in what is delivered.
void name_morph_target(const MorphEnd& end, Delivery& delivery);

} // namespace orbis
