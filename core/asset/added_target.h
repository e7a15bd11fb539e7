// A morph target that the input does not have: what the rest of the document must say about it.
#pragma once

#include <span>

#include "core/asset/asset.h"
#include "core/asset/output.h"

namespace orbis::asset {

// For each mesh with a new primitive that has an `added_target`, which is then the last target of all its new
// primitives: primitives that stay as they were (points, lines) get a target without movement; mesh.weights, the
// weights of nodes that show the mesh, and animations of either get a zero for it, so that everything looks as before;
// and mesh.extras.targetNames ends with its name (numbers stand for targets without one).
void describe_added_targets(Output& out, const Asset& asset, std::span<const NewPrimitive> primitives);

} // namespace orbis::asset
