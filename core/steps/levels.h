// Levels of detail: made, measured, delivered and proved like the full surface.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/lod/simplify.h"
#include "core/progress.h"
#include "core/report.h"
#include "core/steps/delivery.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {

struct DetailLevel {
  lod::Level level;
  Delivery delivery;
};

// The levels that options.lods asks for; none where it is empty. Ratios count the triangles of the surface before it
// was cut for the atlas. Fills report.levels but for what is proved on the file and what is seen when all maps are
// there (likeness.h), and notes what a target cost. Reports Stage::levels.
[[nodiscard]] std::vector<DetailLevel> make_levels(const asset::Asset& asset, const Surface& surface,
                                                   const texture::CutMesh& cut, Progress& progress, Report& report);

// Normals and tangents of the full surface and of all levels in 16 bits.
void quantise(Delivery& full, std::span<DetailLevel> levels);

// As write_asset takes them.
[[nodiscard]] std::vector<asset::NewLevel> in_asset(std::span<const DetailLevel> levels, const Report& report);

// Reads the levels back from the finished file and proves on its numbers that no triangle is folded, on the sphere or
// in the atlas, and that a component which is closed covers its sphere once. Fills report.levels' folded and degree.
// Throws Error{not_certified} where that fails.
void certify_levels(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                    std::span<const DetailLevel> levels, Report& report);

// The same for the file that holds level `number` alone. Throws Error{not_certified}.
void certify_level_file(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                        const DetailLevel& level, std::size_t number);

} // namespace orbis
