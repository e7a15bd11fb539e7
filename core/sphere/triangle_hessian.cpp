#include "core/sphere/triangle_hessian.h"

namespace orbis::sphere {

// The squared length of the edge opposite corner k is 2 A (cot_i + cot_j).
HatGradients hat_gradients(const std::array<double, 3>& cot, double area) {
  const double length = std::sqrt(2 * area * (cot[0] + cot[1])); // from corner 0 to 1, opposite 2
  const double y2 = 2 * area / length, x2 = y2 * cot[0];
  const double inverse = 1 / (2 * area);
  return {{-y2 * inverse, y2 * inverse, 0}, {(x2 - length) * inverse, -x2 * inverse, length * inverse}};
}

// Blinn, Consider the lowly 2 x 2 matrix (1996): a rotation part of size q and a reflection part of size r, at angles
// u - v and u + v. The half angles come from square roots.
Svd decompose(double a, double b, double c, double d) {
  const double e = 0.5 * (a + d), f = 0.5 * (a - d), g = 0.5 * (c + b), h = 0.5 * (c - b);
  const double q = std::sqrt(e * e + h * h), r = std::sqrt(f * f + g * g);
  const double qx = q > 0 ? e / q : 1, qy = q > 0 ? h / q : 0;
  const double rx = r > 0 ? f / r : 1, ry = r > 0 ? g / r : 0;
  const double cos_2u = qx * rx - qy * ry, sin_2u = qx * ry + qy * rx;
  // The larger of cosine and sine first: the other is then a quotient without cancellation.
  const double larger = std::sqrt(0.5 * (1 + std::abs(cos_2u))), smaller = 0.5 * sin_2u / larger;
  const double cu = cos_2u >= 0 ? larger : smaller, su = cos_2u >= 0 ? smaller : larger;
  return {q + r, q - r, cu, su, cu * qx + su * qy, su * qx - cu * qy};
}

void TriangleHessian::mirror() {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Block& b = blocks_[i][j];
    blocks_[j][i] = {b[0], b[2], b[1], b[3]};
  }
}

} // namespace orbis::sphere
