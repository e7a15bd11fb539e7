// The energy of a piecewise map onto the sphere, written with the determinant instead of the chordal area
// (docs/parametrization.md, "The energy"). For a triangle (p, a, b) with reference area A and reference angles,
//
//   D = 1/2 sum cot(opposite angle) |edge|^2    twice the Dirichlet energy of the linear map (Pinkall and Polthier
//   1993) V = det(p, a, b)                            twice the image's area to first order, 0 exactly at a fold E = D
//   h(V)                                  with h of the family in triangle_energy.h; A where isometric
//
// E is a barrier: it grows without bound exactly when the triangle stops being positively oriented as seen from the
// centre.
//
// On the sphere |p| = 1, so D and V are both linear functions of p. Along the retraction p(s) = (p + s) / |p + s| of a
// tangent vector s a linear function g . p has gradient g (its tangential part) and Hessian -(g . p) I at s = 0:
//
//   D: gradient -(cot_b a + cot_a b),  Hessian (cot_b a.p + cot_a b.p) I      V: gradient a x b,  Hessian -V I
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/sphere/reference.h"
#include "core/sphere/sphere_math.h"
#include "core/sphere/star_table.h"
#include "core/sphere/triangle_energy.h"

namespace orbis::sphere {

// A triangle (p, a, b) of the star of p.
struct StarTerm {
  Vec3d a, b;
  double cot_a, cot_b; // at a (opposite the edge p b) and at b (opposite p a)
  double fixed;        // 1/2 cot_p |a - b|^2, which does not depend on p
  double area;         // A
};

inline StarTerm make_term(const Vec3d& a, const Vec3d& b, const Reference& reference, std::size_t corner) {
  return {a,
          b,
          double{reference.cot[(corner + 1) % 3]},
          double{reference.cot[(corner + 2) % 3]},
          0.5 * double{reference.cot[corner]} * squared_norm(a - b),
          double{reference.area}};
}

// The terms of the star of v; `star` is overwritten.
inline void gather_star(mesh::Index v, const StarTable& stars, std::span<const Reference> references,
                        std::span<const Vec3d> points, std::vector<StarTerm>& star) {
  const std::span<const StarCorner> corners = stars[v];
  star.resize(corners.size());
  const Vec3d* a = &points[corners[0].next];
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3d* b = &points[previous_in(corners, k)];
    star[k] = make_term(*a, *b, references[corners[k].triangle()], corners[k].place());
    a = b;
  }
}

// E of the star of p; infinite where a triangle is not positively oriented. p: unit length. Energy: of the family.
template <class Energy> double star_energy(const Energy& energy, std::span<const StarTerm> star, const Vec3d& p) {
  double sum = 0;
  for (const StarTerm& t : star) {
    const Vec3d u = t.a - p, v = t.b - p;
    const double V = dot(p, cross(u, v));
    if (!(V > 0)) return std::numeric_limits<double>::infinity();
    const double D = 0.5 * (t.cot_b * squared_norm(u) + t.cot_a * squared_norm(v)) + t.fixed;
    sum += D * energy.value(V, t.area);
  }
  return sum;
}

// Two orthonormal tangent vectors at p (Duff et al., Building an orthonormal basis, revisited, 2017).
struct TangentFrame {
  Vec3d x, y;
  explicit TangentFrame(const Vec3d& p) {
    const double sign = std::copysign(1.0, p.z), k = -1 / (sign + p.z), xy = p.x * p.y * k;
    x = {1 + sign * p.x * p.x * k, sign * xy, -sign * p.x};
    y = {xy, sign + p.y * p.y * k, -p.y};
  }
};

// Second-order expansion of the star's energy in the tangent plane of p.
struct Expansion {
  double energy = 0;
  double gx = 0, gy = 0;            // gradient
  double hxx = 0, hxy = 0, hyy = 0; // Hessian
};

template <class Energy>
Expansion expand(const Energy& energy, std::span<const StarTerm> star, const Vec3d& p, const TangentFrame& frame) {
  Expansion out;
  for (const StarTerm& t : star) {
    const Vec3d u = t.a - p, v = t.b - p;
    const Vec3d uv = cross(u, v);
    const double V = dot(p, uv);
    const double D = 0.5 * (t.cot_b * squared_norm(u) + t.cot_a * squared_norm(v)) + t.fixed;
    const Vec3d dD = -(t.cot_b * u + t.cot_a * v);
    const Vec3d dV = cross(p, v - u) + uv; // a x b from differences, but for a part along p
    const double Dx = dot(dD, frame.x), Dy = dot(dD, frame.y), Vx = dot(dV, frame.x), Vy = dot(dV, frame.y);
    const auto [h, h1, h2] = energy.jet(V, t.area);
    const double d_hessian = t.cot_b * dot(t.a, p) + t.cot_a * dot(t.b, p);
    const double diagonal = h * d_hessian - D * h1 * V;
    out.energy += D * h;
    out.gx += h * Dx + D * h1 * Vx;
    out.gy += h * Dy + D * h1 * Vy;
    out.hxx += diagonal + 2 * h1 * Dx * Vx + D * h2 * Vx * Vx;
    out.hyy += diagonal + 2 * h1 * Dy * Vy + D * h2 * Vy * Vy;
    out.hxy += h1 * (Dx * Vy + Dy * Vx) + D * h2 * Vx * Vy;
  }
  return out;
}

// A step in the tangent plane.
struct Descent {
  double x = 0, y = 0;
};

// -H^-1 g with the eigenvalues of H replaced by their magnitudes, none below a part of the largest.
[[nodiscard]] Descent descent_step(const Expansion& e);

// A Newton step from p that lowers the star's energy: the Hessian's eigenvalues are made positive, the step is cut
// short of the nearest fold and halved until E falls. Returns p itself where no step does. `gain` becomes the fraction
// of E that was gained.
template <class Energy>
[[nodiscard]] Vec3d newton_step(const Energy& energy, std::span<const StarTerm> star, const Vec3d& p, double& gain);

} // namespace orbis::sphere
