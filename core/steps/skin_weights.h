// Skinning influences at blended vertices.
#pragma once

#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/steps/interpolate.h"

namespace orbis {

// Overwrites JOINTS_n and WEIGHTS_n of the blended vertices in `out`: the corners' influences by joint, added up, the
// strongest kept (four a set), their weights brought to sum 1 in the attribute's own type. Joints without weight are 0.
//   attributes  the input's; out: the output's, one per input attribute in the same order
void merge_skin_weights(std::span<const asset::Attribute> attributes, std::span<const VertexSource> sources,
                        std::vector<asset::Attribute>& out);

} // namespace orbis
