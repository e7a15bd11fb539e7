// A closed genus-0 mesh unfolded onto the unit sphere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/checkpoints.h"
#include "core/mesh/triangle_mesh.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/sphere/triangle_energy.h"

namespace orbis::sphere {

struct Embedding {
  std::vector<Vec3d> points; // unit length, one per vertex of the mesh; every triangle is positively oriented
  // Wall time of the paper's steps, in milliseconds: simplification, refinement, optimisation.
  double t1_ms = 0, t2_ms = 0, t3_ms = 0;
  std::uint64_t relaxations = 0; // vertex moves that were made
  bool converged = true;         // false: a bound on the work was reached first; the map is valid all the same
};

// The paper's method (Birkholz 2004), made safe at any size: see shape_preserving.cpp.
//   threshold  relaxation stops when the best local improvement ds(p*)/ds(p) is above it; in (0, 1)
// mesh: closed, connected, consistently oriented, genus 0, at least 4 vertices, no repeated edges (classify says so).
// Reports Stage::simplify, refine and optimise. Throws Error{canceled}; Error{not_certified} only if a vertex found no
// place.
[[nodiscard]] Embedding embed_shape_preserving(const mesh::TriangleMesh& mesh, double threshold, Progress& progress);

// Least energy of a family (triangle_energy.h) on a hierarchy of independent vertex removals: see isometric.cpp.
// Same requirements. quality: how many Newton steps of the whole map follow the hierarchy. The result does not depend
// on `threads` (0: as many as the machine has), nor on interruptions: levels are kept in `checkpoints`, and the work
// goes on from the one that is kept there.
[[nodiscard]] Embedding embed_by_energy(const mesh::TriangleMesh& mesh, const TriangleEnergy& energy, Quality quality,
                                        std::uint32_t threads, Progress& progress, Checkpoints& checkpoints);

// The default: symmetric Dirichlet energy.
[[nodiscard]] inline Embedding embed_isometric(const mesh::TriangleMesh& mesh, Quality quality, std::uint32_t threads,
                                               Progress& progress) {
  NoCheckpoints none;
  return embed_by_energy(mesh, SymmetricDirichlet{}, quality, threads, progress, none);
}

// What the options ask for: objective, area_weight, quality, threshold. The paper's method keeps no checkpoints.
[[nodiscard]] Embedding embed(const mesh::TriangleMesh& mesh, const Options& options, std::uint32_t threads,
                              Progress& progress, Checkpoints& checkpoints);

// The paper's "Minimum", Eq. 3: sum over vertices of sum_j w_ij theta_ij^2, with Floater's (1997) weights of the mesh.
[[nodiscard]] double shape_preserving_energy(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& points);

} // namespace orbis::sphere
