#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

#include "core/sphere/energy_modes.h"

using namespace orbis;
using Eigen::Matrix2d, Eigen::Matrix4d;

namespace {

// The second derivative of psi(F) = |F|^2 g(det F), by differences, with what is negative left out.
template <class Energy> Matrix4d convex_part_by_differences(const Energy& energy, const Matrix2d& F) {
  const auto psi = [&](const Matrix2d& f) { return f.squaredNorm() * energy.value(f.determinant(), 0.5); };
  const double d = 1e-4;
  Matrix4d second;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const auto at = [&](double x, double y) {
        Matrix2d f = F;
        f(a) += x;
        f(b) += y;
        return psi(f);
      };
      second(a, b) = (at(d, d) - at(d, -d) - at(-d, d) + at(-d, -d)) / (4 * d * d);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix4d> modes(second);
  return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
}

Eigen::Vector4d flat(const Matrix2d& m) { return m.reshaped(); }

template <class Energy> Matrix4d convex_part(const Energy& energy, const Matrix2d& F) {
  const Eigen::JacobiSVD<Matrix2d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const sphere::Modes m = sphere::modes_of(energy, svd.singularValues()[0], svd.singularValues()[1]);
  const auto mode = [&](double a, double b, double c, double d) {
    Matrix2d inner;
    inner << a, b, c, d;
    return flat(svd.matrixU() * inner * svd.matrixV().transpose());
  };
  const double r = std::sqrt(0.5);
  Matrix4d modes;
  modes << mode(m.c, 0, 0, m.s), mode(-m.s, 0, 0, m.c), mode(0, r, r, 0), mode(0, -r, r, 0);
  return modes * Eigen::Vector4d(m.lambda.data()).asDiagonal() * modes.transpose();
}

} // namespace

TEST_CASE("the modes are the second derivative of the energy, with what is negative left out") {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto check = [&](const auto& energy) {
    for (int i = 0; i < 100; ++i) {
      Matrix2d F;
      do {
        for (double& e : F.reshaped()) e = normal(random);
      } while (F.determinant() < 0.3);
      const Matrix4d expected = convex_part_by_differences(energy, F);
      CHECK((convex_part(energy, F) - expected).norm() < 1e-4 * expected.norm());
    }
  };
  check(sphere::SymmetricDirichlet{});
  check(sphere::Stretch{});
  check(sphere::AreaWeighted{0});
  check(sphere::AreaWeighted{0.3});
}

TEST_CASE("where both stretches are equal the modes are finite and none is negative") {
  for (const double s : {1e-3, 1.0, 1e3}) {
    const sphere::Modes m = sphere::modes_of(sphere::SymmetricDirichlet{}, s, s);
    for (const double lambda : m.lambda) CHECK(lambda >= 0);
    CHECK(m.c * m.c + m.s * m.s == doctest::Approx(1));
  }
}
