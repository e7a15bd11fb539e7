// The atlas' images: the base colour, the maps of the materials, and what is baked of the geometry.
#pragma once

#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/pipeline.h"
#include "core/steps/delivery.h"
#include "core/steps/levels.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"

namespace orbis {

struct BakedMaps {
  std::vector<asset::NewImage> images; // that materials show; delivery.primitives[].textures counts in them
  std::vector<MapFile> files;          // every map, by file name
  std::vector<texture::Image> pages;   // the base colour page by page, for pictures
};

// A surface with its place in the atlas.
struct SurfaceInAtlas {
  const asset::Asset& asset;
  const Surface& surface;
  const texture::CutMesh& cut;
};

// Bakes what options.maps asks for, page by page, and changes the delivered primitives to fit: which images their
// materials show, TANGENT (and NORMAL) where a normal map is baked, COLOR_n set aside as _COLOR_n where the base colour
// contains it or must not be multiplied by it. Fills report.maps.
//
// Levels of detail show the same maps, but for the normal map: all of them share a second one, written in the smooth
// tangent frames of the coarsest level, which the other levels' vertices take over (docs/baking.md says why).
//
// The texels show `from`; the delivered triangles are those of `shown`, whose atlas it is. Both are the same but for a
// remesh, whose maps show the input; primitives and materials are the same in any case.
//
// A texture that is not baked keeps its old coordinates, which are still there. Throws Error: invalid_option where
// texture=base_color or cubemap is asked for and there is no such image, or not the right ones; malformed,
// unsupported_format or too_large for an image that cannot be read.
[[nodiscard]] BakedMaps bake_maps(const Request& request, const Limits& limits, const SurfaceInAtlas& from,
                                  const SurfaceInAtlas& shown, Delivery& delivery, std::span<DetailLevel> levels,
                                  Progress& progress, Report& report);

// The first page's base colour as PNG.
[[nodiscard]] std::vector<std::byte> atlas_picture(const BakedMaps& maps, const Options& options);

} // namespace orbis
