// Levels of detail on one atlas: the delivered mesh with fewer and fewer triangles, its map kept fold-free.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/lod/full_surface.h"
#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/atlas.h"
#include "core/vec3.h"

namespace orbis::lod {

// When a level is coarse enough. The coarsest that a bound allows where it gives one, else the number of triangles.
struct Target {
  std::uint64_t triangles = 0; // as many at most; 0: as few as the bound allows
  double deviation = 0;        // root mean square, at any vertex, as a fraction of the bounding box's diagonal; 0: any
};

// What gave way for a target.
struct Concessions {
  bool turned_normals = false; // triangles may turn by more than 80 degrees in one step
  double outline = 0;          // how far, in the atlas, a seam between materials has left its line
  std::uint64_t torn = 0;      // edges at which the two sides no longer show the same place of the atlas
  std::uint64_t opened = 0;    // points of a cut's rim that went while those on its other rims stayed: a gap may show
  std::uint64_t lost_components = 0; // components left out, the smallest first
  std::uint64_t lost_triangles = 0;  // that those had
  double largest_lost = 0;           // the diagonal of the largest one's bounding box, fraction of the model's
  bool is_short = false;             // not reached for all that, or a level before it was coarser already
};

struct Level {
  // The level as a cut of the full surface: each vertex with its place on a triangle of the welded surface, where its
  // attributes come from, its unit vector and its place in the atlas. Points are numbered anew.
  texture::CutMesh mesh;
  std::vector<Vec3f> positions;       // one per vertex; the same bits at every copy of a point
  std::vector<std::uint32_t> near;    // vertex -> a triangle of the full surface's cut close to it in the atlas
  std::vector<std::uint32_t> regions; // triangle -> region, as in FullSurface
  Concessions concessions;
  double deviation = 0; // the largest root mean square deviation that the quadrics have seen, fraction of the diagonal
};

// Edge collapses in the order of their texture deviation (deviation_quadric.h), one level after the other.
//
//   targets  from fine to coarse; a target that is already met gives the level before it again
//
// On every level: triangles are positively oriented in the atlas and on the sphere, exactly, wherever those of the full
// surface are; none covers a place in the atlas that the chart does not; copies of a point along a seam agree to the
// bit, but where seams are broken, which costs as much as price_of_seams says. A component keeps its topology until a
// target cannot be met otherwise: Concessions says what gave way. No level is empty.
//
// O(n log n). The collapses take one thread; the last touch of a level (refine.h) runs beside those for the next one if
// there is a thread for it. The same bits with any number. Reports Stage::levels; throws
// Error{canceled}.
[[nodiscard]] std::vector<Level> simplify(const FullSurface& full, std::span<const Target> targets,
                                          mesh::ThreadPool& threads, Progress& progress);

} // namespace orbis::lod
