// How much the levels of detail look like the full surface, as delivered.
#pragma once

#include <span>

#include "core/asset/asset.h"
#include "core/progress.h"
#include "core/report.h"
#include "core/steps/bake_maps.h"
#include "core/steps/delivery.h"
#include "core/steps/levels.h"
#include "core/texture/atlas.h"

namespace orbis {

// Fills the psnr of report.levels: pictures (core/lod/render.h) of each level as a glTF renderer lights it, through the
// normal map that it is delivered with, read from the finished image, in its own NORMAL and TANGENT; without one with
// NORMAL alone. Against the full surface with its own normals: NORMAL, its triangles' where it came without, and
// through its map where the input has one.
void measure_likeness(const asset::Asset& asset, const texture::CutMesh& cut, const Delivery& full,
                      std::span<const DetailLevel> levels, const BakedMaps& maps, const Progress& progress,
                      Report& report);

} // namespace orbis
