// Triangle strips and fans as lists.
#pragma once

#include <cstdint>
#include <vector>

namespace orbis::asset {

// glTF modes 4 (list), 5 (strip) and 6 (fan), with the winding of the specification (section 3.7.2.1). Indices that are
// left over, too few for a triangle, are dropped. Three indices per triangle come back.
[[nodiscard]] std::vector<std::uint32_t> triangle_list(std::vector<std::uint32_t> indices, int mode);

} // namespace orbis::asset
