// How evenly texels are spread over a surface.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace orbis::texture {

// Of one triangle.
struct Density {
  double texels_per_area, area;
};

inline void sort_by_density(std::vector<Density>& densities) {
  std::sort(densities.begin(), densities.end(),
            [](const Density& a, const Density& b) { return a.texels_per_area < b.texels_per_area; });
}

// The density that this fraction of the surface, by area, does not reach; 0 of no surface.
inline double percentile(std::span<const Density> sorted, double total_area, double fraction) {
  double below = 0;
  for (const Density& d : sorted) {
    below += d.area;
    if (below >= fraction * total_area) return d.texels_per_area;
  }
  return sorted.empty() ? 0 : sorted.back().texels_per_area;
}

} // namespace orbis::texture
