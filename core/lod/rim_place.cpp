#include "core/lod/rim_place.h"

#include <cmath>

namespace orbis::lod {

HalfPlane HalfPlane::beside(const Uv& a, const Uv& b, int sign, double margin) {
  const double x = b[0] - a[0], y = b[1] - a[1], length = std::hypot(x, y);
  const double scale = length > 0 ? sign / length : 0;
  const Uv normal{-y * scale, x * scale};
  return {normal, normal[0] * a[0] + normal[1] * a[1] + (length > 0 ? margin : 0)};
}

std::optional<Uv> best_place_within(const DeviationQuadric::Reduced& model, const Uv& from,
                                    std::span<const HalfPlane> allowed) {
  const double g0 = model.gradient[0], g1 = model.gradient[1];
  const double h00 = model.hessian[0], h01 = model.hessian[1], h11 = model.hessian[2];
  const double determinant = h00 * h11 - h01 * h01;
  if (!(determinant > 0)) return std::nullopt;
  std::optional<Uv> best;
  double least = 0;
  const auto consider = [&](const Uv& u) {
    const double x = u[0] - from[0], y = u[1] - from[1];
    for (const HalfPlane& h : allowed) {
      const double rounding = 1e-12 * (std::abs(u[0]) + std::abs(u[1]));
      if (h.normal[0] * u[0] + h.normal[1] * u[1] < h.offset - rounding) return;
    }
    const double value = 2 * (g0 * x + g1 * y) + h00 * x * x + 2 * h01 * x * y + h11 * y * y;
    if (best && !(value < least)) return;
    best = u;
    least = value;
  };
  const Uv free{from[0] - (h11 * g0 - h01 * g1) / determinant, from[1] - (h00 * g1 - h01 * g0) / determinant};
  consider(free);
  if (best) return best;
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    const auto& [n, offset] = allowed[i];
    // From the free optimum to the line, conjugate to its direction: along H^-1 n.
    const Uv way{(h11 * n[0] - h01 * n[1]) / determinant, (h00 * n[1] - h01 * n[0]) / determinant};
    const double speed = n[0] * way[0] + n[1] * way[1];
    if (speed > 0) {
      const double t = (offset - n[0] * free[0] - n[1] * free[1]) / speed;
      consider({free[0] + t * way[0], free[1] + t * way[1]});
    }
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [m, other] = allowed[j];
      const double d = n[0] * m[1] - n[1] * m[0];
      if (std::abs(d) > 1e-6) consider({(offset * m[1] - other * n[1]) / d, (other * n[0] - offset * m[0]) / d});
    }
  }
  return best;
}

} // namespace orbis::lod
