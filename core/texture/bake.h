// What a page of the atlas shows: a test pattern, a cube map or equirectangular image, or the model's own base colour.
//
// Every texel of a chart belongs to exactly one point of the surface: the delivered triangle that its centre lies in,
// and the weights there. The gutters repeat the nearest such texel.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/progress.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/vec3.h"

namespace orbis::texture {

// A numbered checker on the sphere: each face of the cube around it has its own colour and name, each field its column
// letter and row number. RGB.
[[nodiscard]] Image bake_pattern(const CutMesh& mesh, std::uint32_t page, Progress& progress);

// Uploaded images, looked up by direction on the sphere.
//   images  six (+X -X +Y -Y +Z -Z, as OpenGL and glTF viewers name px, nx, py, ny, pz, nz; see cube_map.h), of any
//           sizes; or one equirectangular image: longitude to the right, its middle at +Z, +X a quarter to the right of
//           it, +Y at the top, as a globe is printed.
// Filtered in linear light. RGBA if any of them is, else RGB. Throws Error{invalid_option} for another number of images
// and for an image without pixels.
[[nodiscard]] Image bake_cube_map(const CutMesh& mesh, std::uint32_t page, std::span<const Image> images,
                                  Progress& progress);

// What a texture does outside [0, 1]; glTF's codes.
enum class Wrap : std::uint16_t { repeat = 10497, clamp = 33071, mirror = 33648 };

// The base colour of one of the input's primitives.
struct BaseColorSource {
  const Image* image = nullptr;           // none: the flat color
  std::array<float, 4> color{1, 1, 1, 1}; // RGBA, linear, as baseColorFactor; unused with an image
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  // KHR_texture_transform, row-major 2 x 3: u' = m0 u + m1 v + m2, v' = m3 u + m4 v + m5
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
};

// The input's own base colour, re-sampled into the atlas through the input's texture coordinates.
//   uv         one per cut vertex, interpolated from the input's, before the transform
//   source_of  one per input triangle: which of `sources` colours it
// Linear in each delivered triangle, as a renderer interpolates, so what is shown is what the input showed. Bilinear in
// linear light; where the image is finer than the atlas, averaged over the texel. Alpha stays straight. RGBA if any
// source has alpha, else RGB.
[[nodiscard]] Image bake_base_color(const CutMesh& mesh, std::uint32_t page, std::span<const Vec2f> uv,
                                    std::span<const std::uint32_t> source_of, std::span<const BaseColorSource> sources,
                                    Progress& progress);

} // namespace orbis::texture
