// Where the components' atlases lie: a grid of equal cells, one cube atlas in each.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/vec3.h"

namespace orbis {

struct CellGrid {
  std::size_t side = 1; // cells in a row

  // From a component's own atlas to the common one.
  [[nodiscard]] Vec2f place(std::size_t component, const Vec2f& uv) const {
    const auto n = static_cast<float>(side);
    const auto column = static_cast<float>(component % side), row = static_cast<float>(component / side);
    return {(column + uv.x) / n, (row + uv.y) / n};
  }
};

[[nodiscard]] inline CellGrid cells_for(std::size_t components) {
  return {static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(components))))};
}

} // namespace orbis
