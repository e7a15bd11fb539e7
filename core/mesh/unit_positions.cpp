#include "core/mesh/unit_positions.h"

#include <algorithm>

namespace orbis::mesh {

std::vector<Vec3d> unit_positions(const TriangleMesh& mesh) {
  Vec3d low(mesh.positions.front()), high = low;
  for (const Vec3f& p : mesh.positions) {
    low = {std::min(low.x, double{p.x}), std::min(low.y, double{p.y}), std::min(low.z, double{p.z})};
    high = {std::max(high.x, double{p.x}), std::max(high.y, double{p.y}), std::max(high.z, double{p.z})};
  }
  const Vec3d size = high - low;
  const double extent = std::max({size.x, size.y, size.z});
  const double scale = extent > 0 ? 1 / extent : 1;
  std::vector<Vec3d> out;
  out.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) out.push_back((Vec3d(p) - low) * scale);
  return out;
}

} // namespace orbis::mesh
