// Levels of detail in a document: the MSFT_lod extension.
#pragma once

#include <functional>
#include <span>

#include "core/asset/asset.h"
#include "core/asset/output.h"

namespace orbis::asset {

// The JSON of a primitive with new geometry: a copy of `base` with the indices and attributes of `geometry`.
using WritePrimitive = std::function<Json(const Json& base, const NewPrimitive& geometry)>;

// Adds the levels' meshes behind the document's, level by level, and makes them alternatives of every node that shows
// the mesh. Materials are those that the full primitives have at the time of the call.
//
// A node that has nothing but its mesh gets the extension itself, and the levels are copies of it. Where children,
// cameras, lights, joints or animations depend on a node, its mesh moves to a child of its own first: what replaces a
// node replaces all that hangs on it. Animated morph weights drive the levels too. A mesh of which nothing is left on
// some level shows the level before there.
void add_levels(Output& out, const Asset& asset, std::span<const NewPrimitive> full, std::span<const NewLevel> levels,
                const WritePrimitive& write);

} // namespace orbis::asset
