// What the atlas shows: a test pattern, a cube map or equirectangular image, or the model's own base colour.
//
// Every texel of a chart belongs to exactly one point of the surface. The gutters show the surface beyond the border,
// as it lies on the neighbouring face, so bilinear and mip-mapped reads cross a seam without a jump.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/vec3.h"

namespace orbis::texture {

// A numbered checker: each face has its own colour and name, each field its column letter and row number. RGB.
[[nodiscard]] Image bake_pattern(const AtlasLayout& layout, Progress& progress);

// Fills all texels outside the charts with what lies beyond the border. image: of the layout's size.
void fill_gutters(const AtlasLayout& layout, Image& image);

} // namespace orbis::texture
