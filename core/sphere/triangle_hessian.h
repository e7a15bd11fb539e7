// The second derivatives of one triangle's energy in the tangent planes of its corners: a mixture of two.
//
// The convex one is that of energy_modes.h, for the triangle's plane: the bend of the sphere is neglected. The exact
// one has the derivatives of D and V (distortion_energy.h), which are linear in each corner; along a sphere they are,
// with p_i the corners and (i, j, k) cyclic,
//
//   D = sum cot_k (1 - p_i . p_j)    d2D/dp_i dp_j = -cot_k I            d2D/dp_i^2 = (cot_k p_i.p_j + cot_j p_i.p_k) I
//   V = det(p_i, p_j, p_k)           d2V/dp_i dp_j (u, v) = det(u, v, p_k)   d2V/dp_i^2 = -V I
//
// and for E = D h(V) the second derivative is h D'' + h' (D' V'^T + V' D'^T + D V'') + D h'' V' V'^T.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sphere/distortion_energy.h"
#include "core/sphere/energy_modes.h"

namespace orbis::sphere {

// Rows of the gradient operator: F = sum over the corners of (position in the plane) x (gradient of its hat function).
struct HatGradients {
  std::array<double, 3> x, y;
};

// The reference triangle with corner 0 at the origin and corner 1 on the x axis.
[[nodiscard]] HatGradients hat_gradients(const std::array<double, 3>& cot, double area);

// Singular values s1 >= |s2| of [a b; c d] = U diag(s1, s2) V^T, and the cosines and sines of the rotations U and V.
struct Svd {
  double s1, s2, cu, su, cv, sv;
};
[[nodiscard]] Svd decompose(double a, double b, double c, double d);

// A triangle on the sphere over its reference.
struct SphereTriangle {
  std::array<Vec3d, 3> p; // counter-clockwise
  std::array<double, 3> cot;
  double area;
};

class TriangleHessian {
public:
  using Block = std::array<double, 4>; // 2 x 2, row-major

  // Energy: of the family. exact_share: in [0, 1]; with 0 the whole is positive semi-definite.
  template <class Energy> TriangleHessian(const Energy& energy, const SphereTriangle& t, double exact_share);

  // Of corners i (rows) and j (columns), in their TangentFrames.
  [[nodiscard]] const Block& block(std::size_t i, std::size_t j) const { return blocks_[i][j]; }

private:
  template <class Energy> void add_convex(const Energy& energy, const SphereTriangle& t, double share);
  template <class Energy> void add_exact(const Energy& energy, const SphereTriangle& t, double share);
  void mirror();

  std::array<TangentFrame, 3> frames_;
  std::array<std::array<Block, 3>, 3> blocks_{};
};

template <class Energy>
TriangleHessian::TriangleHessian(const Energy& energy, const SphereTriangle& t, double exact_share)
    : frames_{TangentFrame(t.p[0]), TangentFrame(t.p[1]), TangentFrame(t.p[2])} {
  if (exact_share < 1) add_convex(energy, t, 1 - exact_share);
  if (exact_share > 0) add_exact(energy, t, exact_share);
  mirror();
}

// Mode k, contracted with the hat gradient of corner i and turned into the corner's frame, is the vector (wx, wy)_ik;
// the block (i, j) is sum_k w_ik w_jk^T.
template <class Energy> void TriangleHessian::add_convex(const Energy& energy, const SphereTriangle& t, double share) {
  const Vec3d e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
  const Vec3d x = normalized(e1), y = cross(normalized(cross(e1, e2)), x); // the triangle's plane
  const HatGradients hat = hat_gradients(t.cot, t.area);
  const double x1 = dot(e1, x), x2 = dot(e2, x), y2 = dot(e2, y);
  const Svd s = decompose(x1 * hat.x[1] + x2 * hat.x[2], x1 * hat.y[1] + x2 * hat.y[2], y2 * hat.x[2], y2 * hat.y[2]);
  const Modes modes = modes_of(energy, s.s1, std::max(s.s2, 1e-9 * s.s1));
  std::array<double, 4> scale{};
  for (std::size_t k = 0; k < 4; ++k) scale[k] = std::sqrt(share * modes.lambda[k] * t.area);
  const Vec3d u1 = s.cu * x + s.su * y, u2 = s.cu * y - s.su * x;
  const double r = std::sqrt(0.5);
  std::array<std::array<double, 4>, 3> wx{}, wy{};
  for (std::size_t i = 0; i < 3; ++i) {
    // Mode matrices: c u1 v1^T + s u2 v2^T, c u2 v2^T - s u1 v1^T, (u1 v2^T + u2 v1^T) r, (u2 v1^T - u1 v2^T) r.
    const double g1 = hat.x[i] * s.cv + hat.y[i] * s.sv, g2 = -hat.x[i] * s.sv + hat.y[i] * s.cv; // hat in V's frame
    const std::array<double, 4> a{modes.c * g1, -modes.s * g1, r * g2, -r * g2};
    const std::array<double, 4> b{modes.s * g2, modes.c * g2, r * g1, r * g1}; // along u1 and u2
    const double xu1 = dot(frames_[i].x, u1), xu2 = dot(frames_[i].x, u2);
    const double yu1 = dot(frames_[i].y, u1), yu2 = dot(frames_[i].y, u2);
    for (std::size_t k = 0; k < 4; ++k) {
      wx[i][k] = scale[k] * (a[k] * xu1 + b[k] * xu2);
      wy[i][k] = scale[k] * (a[k] * yu1 + b[k] * yu2);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (const std::size_t j : {i, (i + 1) % 3}) {
      Block& out = blocks_[i][j];
      for (std::size_t k = 0; k < 4; ++k) {
        out[0] += wx[i][k] * wx[j][k];
        out[1] += wx[i][k] * wy[j][k];
        out[2] += wy[i][k] * wx[j][k];
        out[3] += wy[i][k] * wy[j][k];
      }
    }
  }
}

template <class Energy> void TriangleHessian::add_exact(const Energy& energy, const SphereTriangle& t, double share) {
  const auto& p = t.p;
  const double V = dot(p[0], cross(p[1] - p[0], p[2] - p[0]));
  double D = 0;
  for (std::size_t k = 0; k < 3; ++k) D += 0.5 * t.cot[k] * squared_norm(p[(k + 1) % 3] - p[(k + 2) % 3]);
  const Jet jet = energy.jet(V, t.area);
  const double h = share * jet.value, h1 = share * jet.first, Dh2 = share * D * jet.second;
  std::array<std::array<double, 2>, 3> d{}, v{}; // the gradients of D and V
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    // From differences, but for parts along p_i.
    const Vec3d dD = t.cot[k] * (p[i] - p[j]) + t.cot[j] * (p[i] - p[k]), dV = cross(p[j], p[k]);
    d[i] = {dot(dD, frames_[i].x), dot(dD, frames_[i].y)};
    v[i] = {dot(dV, frames_[i].x), dot(dV, frames_[i].y)};
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    for (const std::size_t column : {i, j}) {
      for (std::size_t e = 0; e < 4; ++e) {
        const std::size_t row = e / 2, col = e % 2;
        blocks_[i][column][e] +=
            h1 * (d[i][row] * v[column][col] + v[i][row] * d[column][col]) + Dh2 * v[i][row] * v[column][col];
      }
    }
    const double diagonal = h * (t.cot[k] * dot(p[i], p[j]) + t.cot[j] * dot(p[i], p[k])) - D * h1 * V;
    blocks_[i][i][0] += diagonal;
    blocks_[i][i][3] += diagonal;
    const TangentFrame &f = frames_[i], &g = frames_[j];
    const Vec3d other = (D * h1) * p[k];
    const Vec3d x = cross(g.x, other) - (h * t.cot[k]) * g.x, y = cross(g.y, other) - (h * t.cot[k]) * g.y;
    Block& mixed = blocks_[i][j];
    mixed[0] += dot(f.x, x);
    mixed[1] += dot(f.x, y);
    mixed[2] += dot(f.y, x);
    mixed[3] += dot(f.y, y);
  }
}

} // namespace orbis::sphere
