// Flat charts to pages: how large they become, where they go, and their vertices' final coordinates.
#pragma once

#include "core/texture/flat_charts.h"

namespace orbis::texture {

struct Placed {
  CutMesh mesh;                      // of all components, in their order; without the triangles that only close holes
  std::vector<std::uint32_t> folded; // components in which some triangle would not keep its orientation
};

// Chooses one texel density for all charts, so that the fullest page is texture_size texels wide, packs every page, and
// sets charts, pages, gutter and uv. charts: one for each component.
//
// The fullest page is texture_size x up to texture_size texels, the others are as small as they can be. The gutter is a
// power of two, up to texture_size / 128 (16 texels at 2048, so that bilinear reads stay within it on the first
// log2(gutter) mip levels), narrower where the gutters of many charts would take too much of the pages. Every chart is
// at least two texels wide and high.
//
// uv are multiples of 2^-24, exact in float32, and every triangle is positively oriented in them, exactly: where
// rounding folds one, its vertices try the places around.
//
// texture_size: 64 to 8192, else Error{invalid_option}, as also where there are more charts than such a page holds.
// Deterministic.
[[nodiscard]] Placed place(std::span<const AtlasComponent> components, std::span<const FlatCharts> charts,
                           std::uint32_t texture_size);

} // namespace orbis::texture
