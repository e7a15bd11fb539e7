// Tangents under nodes that mirror.
#pragma once

#include <span>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/steps/delivery.h"
#include "core/steps/levels.h"

namespace orbis {

// Renderers make the bitangent, w cross(N, T), of vectors that a node has transformed already: under a node that
// mirrors it points the other way, and what a normal map raises looks sunk. So TANGENT's w is negated where a mesh is
// mirrored at all of its nodes: on every level that shows a normal map, and on the full surface where the TANGENT is
// ours alone (with one of its own the input looked as its renderer made it look, and goes on doing so). Where a mesh is
// mirrored at some nodes and not at others, its primitives are marked, and nodes that mirror get copies
// (asset/mirrored_instances.h). The instances of one node share its mesh: where only some of them mirror, that is
// noted.
void mirror_tangents(const asset::Asset& asset, Delivery& delivery, std::span<DetailLevel> levels, Report& report);

} // namespace orbis
