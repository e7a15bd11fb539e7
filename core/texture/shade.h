// Every texel of a page on all threads.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/mesh/thread_pool.h"
#include "core/progress.h"
#include "core/texture/texel_map.h"

namespace orbis::texture {

// Walks over the map (TexelMap::walk) block of rows by block of rows, each with a shader of its own made by `make`.
// Shaders write the texels that they are called for and nothing else. texels_a_look: between two looks at `progress`,
// a fraction of a second. Throws Error{canceled}.
template <class Make>
void shade(const TexelMap& map, mesh::ThreadPool& pool, const Progress& progress, Make make,
           std::size_t texels_a_look = std::size_t{1} << 21U) {
  constexpr std::size_t rows_a_block = 16;
  const std::size_t rows =
      std::max(texels_a_look / std::max(map.width(), 1U) / rows_a_block, std::size_t{1}) * rows_a_block;
  for (std::size_t first = 0; first < map.height(); first += rows) {
    progress.check();
    pool.for_blocks(std::min<std::size_t>(rows, map.height() - first), rows_a_block,
                    [&](std::size_t begin, std::size_t end) {
                      auto shader = make();
                      map.walk(first + begin, first + end, shader);
                    });
  }
}

} // namespace orbis::texture
