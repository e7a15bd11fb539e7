#include "core/lod/refine.h"

#include "core/lod/fit_positions.h"

namespace orbis::lod {
namespace {

constexpr int rounds = 3;

} // namespace

void refine(const FullSurface& full, Level& level) {
  if (level.mesh.triangles.size() == full.cut().triangles.size()) return; // it is the full surface
  Draft draft(full, level);
  for (int round = 0; round < rounds; ++round) {
    relocate(draft);
    flip_edges(draft);
  }
  draft.write_positions();
  fit_positions(full, level);
}

} // namespace orbis::lod
