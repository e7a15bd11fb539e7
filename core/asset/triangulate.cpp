#include "core/asset/triangulate.h"

#include <cstddef>

namespace orbis::asset {

std::vector<std::uint32_t> triangle_list(std::vector<std::uint32_t> indices, int mode) {
  if (mode == 4) {
    indices.resize(indices.size() / 3 * 3);
    return indices;
  }
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
    if (mode == 5) {
      // Every second triangle of a strip has its last two corners swapped, so that all wind alike.
      out.insert(out.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else {
      out.insert(out.end(), {indices[i + 1], indices[i + 2], indices[0]});
    }
  }
  return out;
}

} // namespace orbis::asset
