#include "core/texture/alignment.h"

#include <algorithm>
#include <cmath>

namespace orbis::texture {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;
using Quaternion = std::array<double, 4>; // real part first

Matrix4 product(const Matrix4& a, const Matrix4& b) {
  Matrix4 result{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

// The eigenvector of the largest eigenvalue of a symmetric matrix, by squaring: A^(2^n) turns every vector to it.
Quaternion leading_eigenvector(Matrix4 a) {
  // Shifted by a bound of the spectrum, so that the largest eigenvalue is also the largest in magnitude.
  double bound = 0;
  for (const auto& row : a) {
    double sum = 0;
    for (const double v : row) sum += std::abs(v);
    bound = std::max(bound, sum);
  }
  if (bound == 0) return {1, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) a[i][i] += bound;
  constexpr int squarings = 20;
  for (int i = 0; i < squarings; ++i) {
    double trace = 0;
    for (std::size_t k = 0; k < 4; ++k) trace += a[k][k];
    for (auto& row : a)
      for (double& v : row) v /= trace;
    a = product(a, a);
  }
  // Every column is a multiple of it now; the longest one is the best conditioned.
  Quaternion best{1, 0, 0, 0};
  double longest = 0;
  for (const auto& row : a) {
    const double length = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] + row[3] * row[3]);
    if (length <= longest) continue;
    longest = length;
    for (std::size_t k = 0; k < 4; ++k) best[k] = row[k] / length;
  }
  return best;
}

Rotation rotation_of(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {{Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           Vec3d{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           Vec3d{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

} // namespace

Rotation best_rotation(std::span<const Vec3d> from, std::span<const Vec3d> to, std::span<const double> weights) {
  std::array<Vec3d, 3> s; // s[i] = sum w from_i * to
  for (std::size_t i = 0; i < from.size(); ++i) {
    s[0] += to[i] * (weights[i] * from[i].x);
    s[1] += to[i] * (weights[i] * from[i].y);
    s[2] += to[i] * (weights[i] * from[i].z);
  }
  const auto& [x, y, z] = s;
  const Matrix4 n{{{x.x + y.y + z.z, y.z - z.y, z.x - x.z, x.y - y.x},
                   {y.z - z.y, x.x - y.y - z.z, x.y + y.x, z.x + x.z},
                   {z.x - x.z, x.y + y.x, -x.x + y.y - z.z, y.z + z.y},
                   {x.y - y.x, z.x + x.z, y.z + z.y, -x.x - y.y + z.z}}};
  return rotation_of(leading_eigenvector(n));
}

} // namespace orbis::texture
