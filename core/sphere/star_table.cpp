#include "core/sphere/star_table.h"

namespace orbis::sphere {

void StarTable::build(std::span<const mesh::Triangle> triangles, std::span<const std::uint32_t> live,
                      std::size_t vertex_count) {
  first_.assign(vertex_count + 1, 0);
  corners_.resize(live.size() * 3);
  for (const std::uint32_t slot : live) {
    for (const mesh::Index v : triangles[slot]) ++first_[v];
  }
  // first_[v] becomes the end of row v, then walks back to its start as the row is filled from behind.
  std::uint32_t end = 0;
  for (std::uint32_t& f : first_) f = end += f;
  for (std::size_t i = live.size(); i-- > 0;) {
    const mesh::Triangle& t = triangles[live[i]];
    for (std::uint32_t k = 0; k < 3; ++k) corners_[--first_[t[k]]] = {t[(k + 1) % 3], t[(k + 2) % 3], 3 * live[i] + k};
  }
}

} // namespace orbis::sphere
