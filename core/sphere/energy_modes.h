// The second derivative of a triangle's energy with respect to its map, in closed form and positive semi-definite.
//
// The energy of a triangle is A psi(F), a function of the singular values s1, s2 of its map F to the triangle's plane:
// psi = T g(J), T = s1^2 + s2^2, J = s1 s2, with g the h of triangle_energy.h. After Smith, de Goes, Kim: Analytic
// eigensystems for isotropic distortion energies (2019), its second derivative has, with F = U diag(s1, s2) V^T, the
// eigenvectors
//
//   flip   (u1 v2^T + u2 v1^T) / sqrt 2    (psi_1 - psi_2) / (s1 - s2) = 2 g - T g'
//   twist  (u2 v1^T - u1 v2^T) / sqrt 2    (psi_1 + psi_2) / (s1 + s2) = 2 g + T g'
//   two scalings in the plane of u1 v1^T and u2 v2^T, those of
//     [ 2 g + 4 J g' + T s2^2 g''     T (3 g' + J g'')          ]
//     [ T (3 g' + J g'')              2 g + 4 J g' + T s1^2 g'' ]
//
// For the symmetric Dirichlet energy and the stretch that matrix is diagonal, with 1/2 (1 + 3 / s^4) and 3 / s^4.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sphere/triangle_energy.h"

namespace orbis::sphere {

struct Modes {
  std::array<double, 4> lambda; // of the two scalings, the flip and the twist; what is negative is left out: 0
  double c, s;                  // the scalings are c u1 v1^T + s u2 v2^T and c u2 v2^T - s u1 v1^T
};

// Energy: of the family. s1 >= s2 > 0.
template <class Energy> [[nodiscard]] Modes modes_of(const Energy& energy, double s1, double s2) {
  const double J = s1 * s2, T = s1 * s1 + s2 * s2;
  const auto [g, g1, g2] = energy.jet(J, 0.5); // h depends on V / A alone
  const double common = 2 * g + 4 * J * g1, mixed = T * (3 * g1 + J * g2);
  const double mean = common + 0.5 * T * T * g2, half = 0.5 * T * (s2 * s2 - s1 * s1) * g2; // half <= 0
  const double radius = std::hypot(half, mixed);
  // (mixed, radius - half), the eigenvector of the larger scaling, does not cancel, for half <= 0.
  const double length = std::hypot(mixed, radius - half);
  const bool any = !(length > 0); // both are equal: every direction will do
  return {{std::max(0.0, mean + radius), std::max(0.0, mean - radius), std::max(0.0, 2 * g - T * g1),
           std::max(0.0, 2 * g + T * g1)},
          any ? 0 : mixed / length,
          any ? 1 : (radius - half) / length};
}

} // namespace orbis::sphere
