// The part of a flat map's energy that measures areas (plane_energy.h), and its derivatives.
#pragma once

#include "core/texture/plane_energy.h"

namespace orbis::texture {

inline constexpr int exponent_of_holes = 1;

[[nodiscard]] inline int exponent_of(const PlaneMesh& mesh, const PlaneReference& r) {
  return r.closes_hole ? exponent_of_holes : mesh.exponent;
}

// n: 1 or a multiple of 4.
[[nodiscard]] inline double power(double c, int n) {
  if (n == 1) return c;
  const double c4 = (c * c) * (c * c);
  double out = c4;
  for (int k = 4; k < n; k += 4) out *= c4;
  return out;
}

// E = D h(x): h = c^n / (2 x) with c = (x + 1/x) / 2, and its derivatives, by those of ln h.
struct AreaFactor {
  double h, h1, h2;

  AreaFactor(double x, int exponent) {
    const double i = 1 / x, c = 0.5 * (x + i), k = 1 / c, c1 = 0.5 * (1 - i * i) * k, c2 = i * i * i * k;
    h = 0.5 * i * power(c, exponent);
    const double g1 = exponent * c1 - i, g2 = exponent * (c2 - c1 * c1) + i * i;
    h1 = h * g1;
    h2 = h * (g1 * g1 + g2);
  }
  // h alone.
  static double at(double x, int exponent) {
    const double i = 1 / x;
    return 0.5 * i * power(0.5 * (x + i), exponent);
  }
};

} // namespace orbis::texture
