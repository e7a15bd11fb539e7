#include "core/sphere/shape_preserving_star.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace orbis::sphere {
namespace {

constexpr int newton_steps = 8;         // a healthy star needs one or two
constexpr double pressed_below = 0.1;   // V / floor
constexpr int backtracks = 20;          // halvings of one step
constexpr int stereographic_rounds = 5; // fixed-point rounds for a starting place

bool in_hemisphere(const Star& star, const Vec3d& p) {
  return std::all_of(star.ring.begin(), star.ring.end(), [&](const Vec3d& q) { return dot(p, q) > 0; });
}

// b for one triangle, and the factor of V's gradient in b's.
double barrier(double volume, double floor) {
  const double x = volume / floor;
  return x < 1 ? floor * (x - 1) * (x - 1) / x : 0;
}

// One round of the paper's fallback: the weighted mean of the neighbours in the tangent plane at p, projected
// stereographically from -p, and back.
Vec3d stereographic_mean(const Star& star, const Vec3d& p) {
  constexpr double farthest = 1e-3; // 1 + cos(theta): keeps an antipodal neighbour at a finite distance
  Vec3d mean;
  for (std::size_t k = 0; k < star.ring.size(); ++k) {
    const Vec3d& q = star.ring[k];
    const double c = dot(p, q);
    mean += (q - p * c) * (star.weight[k] * 2 / std::max(1 + c, farthest));
  }
  // A tangent vector y goes back to the sphere at ((4 - |y|^2) p + 4 y) / (4 + |y|^2).
  const double m = squared_norm(mean);
  return normalized((p * (4 - m) + mean * 4.0) * (1 / (4 + m)));
}

// Moves from `from` towards `to` along the chord, halving, until the energy is below `energy`. False: nowhere.
bool approach(const Star& star, const Vec3d& from, const Vec3d& to, double floor, Vec3d& point, double& energy) {
  double t = 1;
  for (int i = 0; i < backtracks; ++i, t *= 0.5) {
    const Vec3d candidate = normalized(from + (to - from) * t);
    const double e = star_energy(star, candidate, floor);
    if (e < energy) {
      point = candidate;
      energy = e;
      return true;
    }
  }
  return false;
}

} // namespace

double squared_angle(double c) {
  if (c > 0.05) {
    const double theta = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(c)));
    return theta * theta;
  }
  // 4 arcsin^2(sqrt(c) / 2) = sum_n 2 c^n / (n^2 binomial(2n, n))
  return c * (1 + c * (1 / 12.0 +
                       c * (1 / 90.0 + c * (1 / 560.0 + c * (1 / 3150.0 + c * (1 / 16632.0 + c * (1 / 84084.0)))))));
}

double angle_energy(const Star& star, const Vec3d& p) {
  double sum = 0;
  for (std::size_t k = 0; k < star.ring.size(); ++k)
    sum += star.weight[k] * squared_angle(squared_norm(star.ring[k] - p));
  return sum;
}

double star_energy(const Star& star, const Vec3d& p, double floor) {
  double sum = 0;
  const std::size_t d = star.ring.size();
  Vec3d a = star.ring[d - 1] - p;
  for (std::size_t k = 0; k < d; ++k) {
    const Vec3d b = star.ring[k] - p;
    const double volume = dot(p, cross(a, b));
    if (!(volume > 0)) return std::numeric_limits<double>::infinity();
    sum += star.weight[k] * squared_angle(squared_norm(b)) + barrier(volume, floor);
    a = b;
  }
  return sum;
}

TangentBasis tangent_basis(const Vec3d& p) {
  // Duff et al., "Building an orthonormal basis, revisited", JCGT 2017: no square root, no bad direction.
  const double s = std::copysign(1.0, p.z), a = -1 / (s + p.z), b = p.x * p.y * a;
  return {{1 + s * p.x * p.x * a, s * b, -s * p.x}, {b, s + p.y * p.y * a, -p.y}};
}

StarDerivatives star_derivatives(const Star& star, const Vec3d& p, double floor) {
  StarDerivatives d;
  const TangentBasis basis = tangent_basis(p);
  d.e1 = basis.e1;
  d.e2 = basis.e2;
  const std::size_t n = star.ring.size();
  Vec3d a = star.ring[n - 1] - p;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3d b = star.ring[k] - p;
    // theta^2: gradient -2 theta u with the unit tangent u towards the neighbour, Hessian 2 (u u' + c (I - u u')),
    // c = theta cot(theta). The tangent part of b has length sin(theta), so that (t1, t2) = sin(theta) u.
    const double chord = squared_norm(b), t1 = dot(b, d.e1), t2 = dot(b, d.e2);
    const double w = star.weight[k], theta2 = squared_angle(chord);
    const double sine2 = std::max(t1 * t1 + t2 * t2, std::numeric_limits<double>::min());
    const double over_sine = std::sqrt(theta2 / sine2); // theta / sin(theta)
    const double c = std::max(over_sine * (1 - 0.5 * chord), 0.0);
    const double radial = theta2 < 1e-4 ? 1 / 3.0 : (1 - c) / sine2; // (1 - c) / sin^2, whose limit is 1/3
    d.value += w * theta2;
    d.g1 -= 2 * w * over_sine * t1;
    d.g2 -= 2 * w * over_sine * t2;
    d.h11 += 2 * w * (c + radial * t1 * t1);
    d.h12 += 2 * w * radial * t1 * t2;
    d.h22 += 2 * w * (c + radial * t2 * t2);

    const Vec3d normal = cross(a, b); // (q_k-1 x q_k) up to a part along p and the part below
    const double volume = dot(p, normal);
    if (volume < floor) {
      // V is linear in p with the gradient n = q_k-1 x q_k = p x (b - a) + a x b. On the sphere V'' = n n' b'' - b' V
      // I.
      const Vec3d n_full = cross(p, b - a) + normal;
      const double n1 = dot(n_full, d.e1), n2 = dot(n_full, d.e2), x = volume / floor;
      const double slope = 1 - 1 / (x * x), curvature = 2 / (x * x * x * floor);
      d.pressed = d.pressed || x < pressed_below;
      d.value += barrier(volume, floor);
      d.g1 += slope * n1;
      d.g2 += slope * n2;
      d.h11 += curvature * n1 * n1 - slope * volume;
      d.h12 += curvature * n1 * n2;
      d.h22 += curvature * n2 * n2 - slope * volume;
    }
    a = b;
  }
  return d;
}

Place best_place(const Star& star, double floor, double gain) {
  const double start = star_energy(star, star.centre, floor);
  Vec3d point = star.centre;
  double energy = start;
  bool pressed = false;
  for (int i = 0; i < stereographic_rounds && !in_hemisphere(star, point); ++i) {
    if (!approach(star, point, stereographic_mean(star, point), floor, point, energy)) break;
  }
  for (int i = 0; i < newton_steps; ++i) {
    const StarDerivatives d = star_derivatives(star, point, floor);
    if (i == 0) pressed = d.pressed;
    const double determinant = d.h11 * d.h22 - d.h12 * d.h12;
    if (!(determinant > 0)) break;
    const double s1 = (d.h12 * d.g2 - d.h22 * d.g1) / determinant, s2 = (d.h12 * d.g1 - d.h11 * d.g2) / determinant;
    const double expected = -0.5 * (d.g1 * s1 + d.g2 * s2);
    if (expected < gain * energy) break;
    if (!approach(star, point, point + d.e1 * s1 + d.e2 * s2, floor, point, energy)) break;
  }
  return {point, start > 0 && std::isfinite(start) ? energy / start : 1, pressed};
}

} // namespace orbis::sphere
