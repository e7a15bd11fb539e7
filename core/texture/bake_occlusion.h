// Ambient occlusion: how much of the sky each point of the surface sees.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/image.h"
#include "core/texture/occluders.h"
#include "core/texture/texel_map.h"
#include "core/vec3.h"

namespace orbis::texture {

inline constexpr std::uint32_t rays_a_texel = 64;

// What hides the sky, by number: surfaces in spaces of their own do not hide each other.
struct Occluders {
  std::span<const OccluderTree> trees;
  std::span<const std::uint32_t> tree_of, component_of; // by triangle of the page's mesh
};

// The visible part of the sky above each texel's point, weighted by the cosine to its normal (what glTF's occlusion
// texture multiplies ambient light with), in all three channels: rays_a_texel rays a texel over the hemisphere of the
// normal, a Hammersley set that is turned from texel to texel, then smoothed over 3 x 3 texels of the same chart. Rays
// that start into the surface's own triangle do not count. Of a surface that is seen from both sides, the side that
// sees more: one texel serves both, and a dark one would darken the side in the open.
//   positions, normals  at the corners of the page mesh's triangles; normals are unit
//   two_sided           by triangle: whether it is seen from both sides; empty: none is
//   offset              how far above the surface rays start, in its units
// Throws Error{canceled}.
[[nodiscard]] Image bake_occlusion(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions,
                                   std::span<const std::array<Vec3f, 3>> normals, const Occluders& occluders,
                                   const std::vector<bool>& two_sided, float offset, const Progress& progress,
                                   mesh::ThreadPool& pool);

} // namespace orbis::texture
