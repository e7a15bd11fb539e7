#include "core/lod/refine.h"

#include "core/lod/fit_positions.h"

namespace orbis::lod {
namespace {

// Where each triangle of the level stands for few of the full surface's, the first round has done nearly all.
constexpr std::size_t few = 8;
constexpr int rounds = 3;

} // namespace

void refine(const FullSurface& full, Level& level, const Progress& progress) {
  if (level.mesh.triangles.size() == full.cut().triangles.size()) return; // it is the full surface
  Draft draft(full, level);
  const bool is_fine = full.cut().triangles.size() < few * level.mesh.triangles.size();
  for (int round = 0; round < (is_fine ? 1 : rounds); ++round) {
    relocate(draft, progress);
    progress.check();
    flip_edges(draft);
  }
  draft.write_positions();
  fit_positions(full, level);
}

} // namespace orbis::lod
