// A morph target that takes the model to its spheres.
#pragma once

#include "core/asset/asset.h"
#include "core/steps/delivery.h"
#include "core/steps/surface.h"

namespace orbis {

// Adds the target "sphere" to every delivered primitive: POSITION, and NORMAL where the primitive has it. At weight 1
// each component is the sphere that it was unfolded onto, around the centroid of its surface and with its area (that of
// the closed component, caps included), so that it neither grows nor shrinks on the whole. In between, vertices move on
// straight lines. What has no place on a sphere stays where it is. delivery: of the full surface or of a level.
void add_sphere_morph(const asset::Asset& asset, const Surface& surface, Delivery& delivery);

} // namespace orbis
