// How far a vertex of a coarser level is from the full surface, as a quadratic function of where the vertex lies in
// space and in the atlas.
//
// Over a triangle of the full surface the map from the atlas to space is affine, P(u) = A u + b. A vertex at position p
// that shows the texel u deviates from it by r = p - A u - b: the texture deviation of Cohen, Olano and Manocha,
// Appearance-preserving simplification (1998), of which the part along the triangle's normal n is the distance that
// Garland and Heckbert's quadrics measure (Surface simplification using quadric error metrics, 1997). The quadric
//
//   Q(p, u) = w ((n . r)^2 + slip (|r|^2 - (n . r)^2)),    0 < slip <= 1
//
// weights the two against each other: slip says how much it costs that the texture slides along the surface. In matrix
// form, with M = slip I + (1 - slip) n n^T, Q = w r^T M r; n^T A = 0 makes the products short.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "core/lod/chart_map.h"
#include "core/vec3.h"

namespace orbis::lod {

// How much it costs that the texture slides along the surface, against a distance from it, squared: docs/lods.md says
// how it was chosen.
inline constexpr double slip = 0.2;

// A symmetric 3x3 matrix by its upper triangle: xx xy xz yy yz zz.
using Symmetric3 = std::array<double, 6>;

[[nodiscard]] inline Vec3d product(const Symmetric3& m, const Vec3d& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
          m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

// The inverse of a positive definite matrix; nothing where rounding leaves no digit of the determinant.
[[nodiscard]] inline std::optional<Symmetric3> inverse(const Symmetric3& m) {
  const double a = m[3] * m[5] - m[4] * m[4], b = m[2] * m[4] - m[1] * m[5], c = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * a + m[1] * b + m[2] * c;
  const double trace = m[0] + m[3] + m[5];
  if (!(determinant > 1e-12 * trace * trace * trace)) return std::nullopt;
  const double s = 1 / determinant;
  return Symmetric3{s * a,
                    s * b,
                    s * c,
                    s * (m[0] * m[5] - m[2] * m[2]),
                    s * (m[1] * m[2] - m[0] * m[4]),
                    s * (m[0] * m[3] - m[1] * m[1])};
}

// Q at a fixed place in the atlas: p^T H p + 2 g . p + c.
struct PositionQuadric {
  Symmetric3 h{};
  Vec3d g;
  double c = 0;

  PositionQuadric& operator+=(const PositionQuadric& o) {
    for (std::size_t i = 0; i < h.size(); ++i) h[i] += o.h[i];
    g += o.g;
    c += o.c;
    return *this;
  }
  [[nodiscard]] double value(const Vec3d& p) const { return dot(p, product(h, p)) + 2 * dot(g, p) + c; }
  // The p of the smallest value.
  [[nodiscard]] std::optional<Vec3d> minimiser() const {
    const std::optional<Symmetric3> i = inverse(h);
    if (!i) return std::nullopt;
    return -product(*i, g);
  }
};

struct DeviationQuadric {
  Symmetric3 pp{};            // p^T pp p
  std::array<Vec3d, 2> pu{};  // 2 p . (pu[0] u[0] + pu[1] u[1])
  std::array<double, 3> uu{}; // uu[0] u0^2 + 2 uu[1] u0 u1 + uu[2] u1^2
  Vec3d gp;
  Uv gu{};
  double c = 0;
  double weight = 0; // sum of the weights w

  // The triangle's map P(u) = u[0] a[0] + u[1] a[1] + b, its unit normal, its weight (an area) and its slip.
  [[nodiscard]] static DeviationQuadric of_map(const std::array<Vec3d, 2>& a, const Vec3d& b, const Vec3d& n, double w,
                                               double own_slip) {
    DeviationQuadric q;
    const double rest = w * (1 - own_slip), s = w * own_slip, offset = dot(n, b);
    q.pp = {s + rest * n.x * n.x, rest * n.x * n.y, rest * n.x * n.z,
            s + rest * n.y * n.y, rest * n.y * n.z, s + rest * n.z * n.z};
    q.pu = {a[0] * -s, a[1] * -s};
    q.uu = {s * dot(a[0], a[0]), s * dot(a[0], a[1]), s * dot(a[1], a[1])};
    q.gp = b * -s - n * (rest * offset);
    q.gu = {s * dot(a[0], b), s * dot(a[1], b)};
    q.c = s * dot(b, b) + rest * offset * offset;
    q.weight = w;
    return q;
  }

  // w times the squared distance from the plane through b with the unit normal n, wherever in the atlas. It adds
  // nothing to the weight that deviations are means by.
  [[nodiscard]] static DeviationQuadric of_plane(const Vec3d& b, const Vec3d& n, double w) {
    const double offset = dot(n, b);
    DeviationQuadric q;
    q.pp = {w * n.x * n.x, w * n.x * n.y, w * n.x * n.z, w * n.y * n.y, w * n.y * n.z, w * n.z * n.z};
    q.gp = n * (-w * offset);
    q.c = w * offset * offset;
    return q;
  }

  // The same wherever in the atlas, as it is at a fixed place.
  [[nodiscard]] static DeviationQuadric held_at(const PositionQuadric& at, double w) {
    DeviationQuadric q;
    q.pp = at.h;
    q.gp = at.g;
    q.c = at.c;
    q.weight = w;
    return q;
  }

  DeviationQuadric& operator+=(const DeviationQuadric& o) {
    for (std::size_t i = 0; i < pp.size(); ++i) pp[i] += o.pp[i];
    for (std::size_t i = 0; i < 2; ++i) {
      pu[i] += o.pu[i];
      gu[i] += o.gu[i];
    }
    for (std::size_t i = 0; i < 3; ++i) uu[i] += o.uu[i];
    gp += o.gp;
    c += o.c;
    weight += o.weight;
    return *this;
  }

  [[nodiscard]] PositionQuadric at(const Uv& u) const {
    return {pp, gp + pu[0] * u[0] + pu[1] * u[1],
            c + uu[0] * u[0] * u[0] + 2 * uu[1] * u[0] * u[1] + uu[2] * u[1] * u[1] +
                2 * (gu[0] * u[0] + gu[1] * u[1])};
  }

  // min_p Q(p, u) as a function of u: its gradient at a place and its Hessian (00, 01, 11), halved both.
  struct Reduced {
    Uv gradient{};
    std::array<double, 3> hessian{};
  };
  // Held near `from` a little: on a flat, evenly mapped surface every u is as good. Nothing where no p is best.
  [[nodiscard]] std::optional<Reduced> reduced(const Uv& from) const {
    constexpr double hold = 1e-3; // of the mean curvature of Q along u
    const std::optional<Symmetric3> i = inverse(pp);
    if (!i) return std::nullopt;
    // p*(u) = -pp^-1 (gp + pu u); the Schur complement S = uu - pu^T pp^-1 pu is the Hessian of what is left.
    const Vec3d c0 = product(*i, pu[0]), c1 = product(*i, pu[1]);
    const double held = hold * 0.5 * (uu[0] + uu[2]);
    const double s0 = uu[0] - dot(pu[0], c0) + held, s1 = uu[1] - dot(pu[0], c1), s2 = uu[2] - dot(pu[1], c1) + held;
    const Vec3d p = -product(*i, gp + pu[0] * from[0] + pu[1] * from[1]);
    const double g0 = gu[0] + uu[0] * from[0] + uu[1] * from[1] + dot(pu[0], p);
    const double g1 = gu[1] + uu[1] * from[0] + uu[2] * from[1] + dot(pu[1], p);
    return Reduced{{g0, g1}, {s0, s1, s2}};
  }

  // The u where that is smallest.
  [[nodiscard]] std::optional<Uv> best_place(const Uv& from) const {
    const std::optional<Reduced> r = reduced(from);
    if (!r) return std::nullopt;
    const auto& [s0, s1, s2] = r->hessian;
    const auto& [g0, g1] = r->gradient;
    const double determinant = s0 * s2 - s1 * s1;
    if (!(determinant > 0)) return std::nullopt;
    return Uv{from[0] - (s2 * g0 - s1 * g1) / determinant, from[1] - (s0 * g1 - s1 * g0) / determinant};
  }
};

} // namespace orbis::lod
