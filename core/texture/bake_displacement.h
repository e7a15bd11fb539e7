// How far the full surface lies from one of its levels of detail, texel by texel: the levels have its atlas.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/texture/texel_map.h"
#include "core/vec3.h"

namespace orbis::texture {

// A mesh that a page shows in the same places as the full surface.
struct CoarseSurface {
  const TexelMap* map = nullptr;
  const CutMesh* mesh = nullptr;
  std::span<const Vec3f> positions; // one per vertex
  std::span<const Vec3f> normals;   // one per vertex, of any length; (0, 0, 0): the triangle's own
};

struct Displacement {
  Image16 image; // one channel: a number n in [0, 1] is the distance offset + n * scale
  double offset = 0, scale = 0;
};

// At each texel, with P the full surface's point, p the coarse one's and N its unit normal there (interpolated and
// brought to unit length, as a shader does): the distance d = (P - p) . N, along which p + d N is as close to P as N
// lets it be. 0 where the coarse surface has nothing in the chart (a component that it left out). positions: by
// triangle of the full page, in the space of POSITION. chart_of: the same triangles' charts.
// Throws Error{canceled}. The same on any number of threads.
[[nodiscard]] Displacement bake_displacement(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions,
                                             std::span<const std::uint32_t> chart_of, const CoarseSurface& coarse,
                                             const Progress& progress, mesh::ThreadPool& pool);

} // namespace orbis::texture
