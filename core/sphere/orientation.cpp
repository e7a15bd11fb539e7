#include "core/sphere/orientation.h"

#include <cmath>

namespace orbis::sphere {
namespace {

constexpr double grid_scale = 1 << grid_bits;

} // namespace

GridPoint to_grid(const Vec3d& p) {
  return {static_cast<std::int32_t>(std::lrint(p.x * grid_scale)),
          static_cast<std::int32_t>(std::lrint(p.y * grid_scale)),
          static_cast<std::int32_t>(std::lrint(p.z * grid_scale))};
}

Vec3f from_grid(const GridPoint& g) {
  constexpr auto scale = static_cast<float>(1.0 / grid_scale);
  return {static_cast<float>(g[0]) * scale, static_cast<float>(g[1]) * scale, static_cast<float>(g[2]) * scale};
}

bool grid_point_of(const Vec3f& p, GridPoint& out) {
  const std::array<double, 3> scaled{double{p.x} * grid_scale, double{p.y} * grid_scale, double{p.z} * grid_scale};
  for (std::size_t i = 0; i < 3; ++i) {
    // Written so that NaN is refused too.
    if (!(std::abs(scaled[i]) <= grid_scale) || scaled[i] != std::rint(scaled[i])) return false;
    out[i] = static_cast<std::int32_t>(scaled[i]);
  }
  return true;
}

int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  // det(a, b, c) = det(a, b - a, c - a). Differences have at most 26 bits, their products 52, the cross product 53:
  // all exact in 64-bit integers. Only the last product, of 25 and 53 bits, and its sum need more.
  const std::int64_t ux = std::int64_t{b[0]} - a[0], uy = std::int64_t{b[1]} - a[1], uz = std::int64_t{b[2]} - a[2];
  const std::int64_t vx = std::int64_t{c[0]} - a[0], vy = std::int64_t{c[1]} - a[1], vz = std::int64_t{c[2]} - a[2];
  const std::int64_t nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  using Wide = __int128;
  const Wide det = Wide{a[0]} * nx + Wide{a[1]} * ny + Wide{a[2]} * nz;
  return (det > 0) - (det < 0);
}

} // namespace orbis::sphere
