// The result as an archive: the model, each of its levels of detail as a file of its own, and what they are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/steps/levels.h"

namespace orbis {

// A zip of
//   model.glb       the result with all levels
//   lod1.glb, …     each level alone, with the document and the textures that the result has
//   manifest.json   what each file is: triangles, vertices, and the measures of the report
// full: as delivered; a level alone shows the full surface's textures where it has none of its own. Each level's file
// is read back and proved like the levels in the result: throws Error{not_certified}. Same input, same bytes.
[[nodiscard]] std::vector<std::byte> archive_of(std::vector<std::byte> model, const asset::Asset& asset,
                                                const Surface& surface, const Delivery& full,
                                                std::span<const DetailLevel> levels,
                                                std::span<const asset::NewImage> atlas, const Report& report);

} // namespace orbis
