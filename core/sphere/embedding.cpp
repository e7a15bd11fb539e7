#include "core/sphere/embedding.h"

namespace orbis::sphere {

Embedding embed(const mesh::TriangleMesh& mesh, const Options& options, std::uint32_t threads, Progress& progress,
                Checkpoints& checkpoints) {
  const auto by = [&](const TriangleEnergy& energy) {
    return embed_by_energy(mesh, energy, options.quality, threads, progress, checkpoints);
  };
  switch (options.objective) {
  case Objective::shape_preserving:
    return embed_shape_preserving(mesh, options.threshold, progress);
  case Objective::conformal:
    return by(AreaWeighted{0});
  case Objective::stretch:
    return by(Stretch{});
  case Objective::isometric:
    break;
  }
  if (options.area_weight < 1) return by(AreaWeighted{options.area_weight});
  return by(SymmetricDirichlet{});
}

} // namespace orbis::sphere
