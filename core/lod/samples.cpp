#include "core/lod/samples.h"

#include <cmath>

namespace orbis::lod {

std::vector<Sample> spread_samples(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                                   std::size_t count) {
  std::vector<double> up_to; // area of the triangles up to each
  up_to.reserve(triangles.size());
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    area += 0.5 * norm(cross(positions[b] - positions[a], positions[c] - positions[a]));
    up_to.push_back(area);
  }
  std::vector<Sample> samples;
  if (!(area > 0)) return samples;
  samples.reserve(count);
  // The reciprocals of the plastic number and of its square.
  constexpr double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
  std::uint32_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    const double at = area * (n + 0.5) / static_cast<double>(count);
    while (t + 1 < up_to.size() && up_to[t] < at) ++t;
    double x = n * step_x - std::floor(n * step_x), y = n * step_y - std::floor(n * step_y);
    if (x + y > 1) {
      x = 1 - x;
      y = 1 - y;
    }
    samples.push_back({t, {1 - x - y, x, y}});
  }
  return samples;
}

} // namespace orbis::lod
