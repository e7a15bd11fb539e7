// What a triangle's map may cost: the family of energies that the solver can minimise.
//
// For a triangle with reference area A, stretched by s1 and s2 along its principal directions, D = A (s1^2 + s2^2) is
// twice the Dirichlet energy of its map and V = 2 A s1 s2 twice the area of its image, to first order
// (distortion_energy.h). Each member is a function of the two, linear in D,
//
//   E = D h(V),   with x = V / (2 A) = s1 s2 the area ratio:
//
//   SymmetricDirichlet   h = 1/4 + 1 / (4 x^2)            E = A (s1^2 + s2^2 + 1/s1^2 + 1/s2^2) / 4
//   Stretch              h = 1 / (2 x^2)                  E = A (1/s1^2 + 1/s2^2) / 2   (Sander et al. 2001, squared)
//   AreaWeighted         h = (w^theta + (c/x)^2) / (2 x)  E = A (s1/s2 + s2/s1) / 2 (w^theta + (c/x)^2),
//                        w = (x + 1/x) / 2
//
// E is A for an isometry (to c^2), and grows without bound where V falls to 0. theta is the dial between angles and
// areas: 0 is conformal (MIPS, Hormann and Greiner 2000), 1 the symmetric Dirichlet energy again. Conformal maps shrink
// a limb exponentially with its length, until no number can tell its vertices apart; below an area ratio of about c the
// last term pushes back, and above it is not felt.
#pragma once

#include <cmath>
#include <variant>

namespace orbis::sphere {

// A function of V and its first two derivatives.
struct Jet {
  double value, first, second;
};

struct SymmetricDirichlet {
  [[nodiscard]] static double value(double V, double area) { return 0.25 + area * area / (V * V); }
  [[nodiscard]] static Jet jet(double V, double area) {
    const double inverse = 1 / V, ratio = area * area * inverse * inverse;
    const double first = -2 * ratio * inverse;
    return {0.25 + ratio, first, -3 * first * inverse};
  }
};

struct Stretch {
  [[nodiscard]] static double value(double V, double area) { return 2 * area * area / (V * V); }
  [[nodiscard]] static Jet jet(double V, double area) {
    const double inverse = 1 / V, ratio = 2 * area * area * inverse * inverse;
    const double first = -2 * ratio * inverse;
    return {ratio, first, -3 * first * inverse};
  }
};

struct AreaWeighted {
  double theta = 0; // in [0, 1]

  // c: triangles of a thousandth of their share's length are still told apart by the delivered coordinates.
  static constexpr double smallest_ratio = 1e-5;

  [[nodiscard]] double value(double V, double area) const {
    const double i = 2 * area / V; // 1 / x
    return 0.5 * i * (power(0.5 * (i + 1 / i)) + smallest_ratio * smallest_ratio * i * i);
  }
  [[nodiscard]] Jet jet(double V, double area) const {
    const double x = V / (2 * area), i = 1 / x, dx = 1 / (2 * area);
    const double w = 0.5 * (x + i), w1 = 0.5 * (1 - i * i), w2 = i * i * i;
    const double p = power(w), p1 = theta * p * w1 / w;
    const double p2 = theta * p * ((theta - 1) * w1 * w1 / w + w2) / w;
    const double floor = smallest_ratio * smallest_ratio * i * i * i;
    return {0.5 * (p * i + floor), 0.5 * (p1 - p * i - 3 * floor) * i * dx,
            0.5 * (p2 - 2 * p1 * i + 2 * p * i * i + 12 * floor * i) * i * dx * dx};
  }

private:
  [[nodiscard]] double power(double w) const { return theta == 0 ? 1 : std::pow(w, theta); }
};

using TriangleEnergy = std::variant<SymmetricDirichlet, Stretch, AreaWeighted>;

} // namespace orbis::sphere
