// The maps of a page: what the input's textures and geometry say, texel by texel.
//
// All of them walk over the same texel map; their gutters come from it. Each is divided among the pool's threads by
// rows, is the same on any number of them, and throws Error{canceled}.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/image.h"
#include "core/texture/tangents.h"
#include "core/texture/texel_map.h"
#include "core/texture/texture_reader.h"
#include "core/vec3.h"

namespace orbis::texture {

// RGBA by corner, linear, as COLOR_0: multiplied with the texture.
using CornerColor = std::array<std::array<float, 4>, 3>;

// A texture of the input, re-sampled.
//   colors  one per triangle of the page's mesh, or empty
//   alpha   whether the image has an alpha channel
[[nodiscard]] Image bake_texture(const TexelMap& map, const TextureReader& reader, std::span<const CornerColor> colors,
                                 Encoding encoding, bool alpha, const Progress& progress, mesh::ThreadPool& pool);

// What the surface's normals are made of, one entry a triangle of the page's mesh.
struct NormalSource {
  std::span<const std::array<Vec3f, 3>> normals;    // unit, in the space of POSITION
  std::span<const std::array<Tangent, 3>> tangents; // of the input's normal maps; empty where there are none
  const TextureReader* detail = nullptr;            // the input's normal maps (linear); null where there are none
  std::span<const float> scales;            // normalTexture.scale by source of `detail`; 0: it has no normal map
  std::span<const std::uint32_t> source_of; // as the reader's
};

// A field of tangent frames: those of a mesh on the same page, interpolated as a renderer does. The mesh may be the
// page's own or a coarser one with the same texture coordinates.
struct FrameField {
  const TexelMap* map = nullptr;
  std::span<const mesh::Triangle> triangles;
  std::span<const Vec3f> normals;    // one per vertex
  std::span<const Tangent> tangents; // one per vertex
};

// Normals as numbers in [0, 1], (n + 1) / 2 each: in the space of POSITION, or with `frames` in the tangent frame that
// glTF renderers build at each pixel: N, T and B = w cross(N, T) at the vertices, interpolated, each brought back to
// unit length, n ~ x T + y B + z N. Picture: Image (8 bits a channel) or Image16.
template <class Picture>
[[nodiscard]] Picture bake_normals(const TexelMap& map, const NormalSource& source, const FrameField* frames,
                                   const Progress& progress, mesh::ThreadPool& pool);

// Points of the surface, brought to [0, 1] by the box: component c is box.low + c (box.high - box.low) in the space of
// POSITION, each texel's own centre. A geometry image.
struct Box {
  Vec3d low, high;
};
[[nodiscard]] Image16 bake_positions(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions,
                                     const Box& box, const Progress& progress, mesh::ThreadPool& pool);

} // namespace orbis::texture
