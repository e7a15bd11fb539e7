// Flat charts to pages: how large they become, where they go, and their vertices' final coordinates.
#pragma once

#include "core/texture/flat_charts.h"

namespace orbis::texture {

struct Placed {
  CutMesh mesh;                      // of all components, in their order; without the triangles that only close holes
  std::vector<std::uint32_t> folded; // components in which some triangle would not keep its orientation
  double texel_density = 0;          // texels per unit of length that the charts were given
};

inline constexpr std::uint32_t widest_page = 8192; // texels

// How large the pages become.
struct AtlasSize {
  std::uint32_t width = 2048; // of the page with most surface, in texels; 64 to widest_page
  // Texels per unit of length on the surface, on average, where that decides in the width's place; 0: it does not.
  double texel_density = 0;
};

// Chooses one texel density for all charts, packs every page, and sets charts, pages, gutter and uv. charts: one for
// each component.
//
// By the width W: the page with most surface is W x up to W texels, the others are as small as they can be. By the
// density: all pages are as small as they can be, and where one would have to be wider than widest_page, that width
// decides. The gutter is a power of two, up to W / 128 (16 texels at 2048, so that bilinear reads stay within it on the
// first log2(gutter) mip levels), narrower where the gutters of many charts would take too much of the pages. Every
// chart is at least two texels wide and high.
//
// uv are multiples of 2^-24, exact in float32, and every triangle is positively oriented in them, exactly: where
// rounding folds one, its vertices try the places around.
//
// Throws Error{invalid_option} where the size is out of range, or there are more charts than such a page holds.
// Deterministic.
[[nodiscard]] Placed place(std::span<const AtlasComponent> components, std::span<const FlatCharts> charts,
                           const AtlasSize& size);

} // namespace orbis::texture
