// What a page of the atlas shows: a test pattern, a cube map or an equirectangular
// image. What the model itself shows: bake_maps.h.
//
// Both walk over the page's texel map, whose triangles are those of `mesh`, row by row on the pool's threads, and are
// the same on any number of them. They throw Error{canceled}.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/texture/texel_map.h"

namespace orbis::texture {

// A numbered checker on the sphere: each face of the cube around it has its own colour and name, each field its column
// letter and row number. RGB. page: the map's.
[[nodiscard]] Image bake_pattern(const TexelMap& map, const CutMesh& mesh, std::uint32_t page, const Progress& progress,
                                 mesh::ThreadPool& pool);

// Uploaded images, looked up by direction on the sphere.
//   images  six (+X -X +Y -Y +Z -Z, as OpenGL and glTF viewers name px, nx, py, ny, pz, nz; see cube_map.h), of any
//           sizes; or one equirectangular image: longitude to the right, its middle at +Z, +X a quarter to the right of
//           it, +Y at the top, as a globe is printed.
// Filtered in linear light. RGBA if any of them is, else RGB. Throws Error{invalid_option} for another number of images
// and for an image without pixels.
[[nodiscard]] Image bake_cube_map(const TexelMap& map, const CutMesh& mesh, std::span<const Image> images,
                                  const Progress& progress, mesh::ThreadPool& pool);

// What a texture does outside [0, 1]; glTF's codes.
enum class Wrap : std::uint16_t { repeat = 10497, clamp = 33071, mirror = 33648 };

} // namespace orbis::texture
