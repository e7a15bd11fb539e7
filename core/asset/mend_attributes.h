// Vertex attributes that break the rules of glTF 2.0, section 3.7.2.1, put right.
#pragma once

#include <vector>

#include "core/asset/asset.h"

namespace orbis::asset {

// Of the attributes in float, and of the morph targets':
//   a number that is infinite or none           becomes 0 (POSITION is check_positions' matter)
//   NORMAL that is no unit vector               is scaled; one without a direction becomes the normal of the triangles
//                                               around its vertex
//   TANGENT that is none, or w not 1 or -1      is scaled; one without a direction becomes one across the normal
//   WEIGHTS_n of a vertex that do not sum to 1  are scaled; without any weight the first joint gets all of it
//   COLOR_n outside of [0, 1]                   is clamped
// Everything else keeps its bits. Each attribute that was changed gets a note "attribute-mended" with the number of its
// vertices.
void mend_attributes(Primitive& primitive, std::vector<Asset::Note>& notes);

} // namespace orbis::asset
