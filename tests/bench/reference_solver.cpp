#include "bench/reference_solver.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>

#include "core/mesh/unit_positions.h"
#include "core/sphere/energy_modes.h"
#include "core/sphere/reference.h"
#include "core/sphere/relaxation.h"
#include "core/sphere/tangent_hessian.h"

namespace orbis::bench {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double enough = 1e-6; // of the energy, left to gain
constexpr double shift = 0.01;  // of the mass matrix; turns of the whole sphere cost nothing
constexpr double longest_step = 8;
constexpr int most_halvings = 20;
// Of the exact Hessian, the rest made convex triangle by triangle: as much as leaves it positive definite.
constexpr std::array<double, 5> shares{0.95, 0.85, 0.7, 0.4, 0};
constexpr double fine_regularisation = 1e-6; // of the references, as the solver's

Eigen::Vector3d eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }

// The 6 x 6 block of a triangle in its vertices' tangent frames: dF = sum dq_i (x) grad hat_i, and the second
// derivative of the energy in dF.
Matrix6d convex_block_of(const std::array<Vec3d, 3>& q, const sphere::Reference& reference) {
  const double area{reference.area}, c0{reference.cot[0]}, c1{reference.cot[1]};
  // The reference triangle: corner 0 at the origin, corner 1 on the x axis at 2 A (cot_0 + cot_1) = length^2.
  const double length = std::sqrt(2 * area * (c0 + c1)), height = 2 * area / length;
  Matrix2d X;
  X << length, height * c0, 0, height;
  const Matrix2d inverse = X.inverse();
  Eigen::Matrix<double, 3, 2> hat;
  hat << -inverse.colwise().sum(), inverse;
  const Eigen::Vector3d e1 = eigen(q[1] - q[0]), e2 = eigen(q[2] - q[0]);
  const Eigen::Vector3d px = e1.normalized(), py = e1.cross(e2).normalized().cross(px);
  Matrix2d Y;
  Y << px.dot(e1), px.dot(e2), py.dot(e1), py.dot(e2);
  const Eigen::JacobiSVD<Matrix2d> svd(Y * inverse, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector2d s = svd.singularValues();
  const sphere::Modes m = sphere::modes_of(sphere::SymmetricDirichlet{}, s[0], std::max(s[1], 1e-9 * s[0]));
  // F has a positive determinant, so where U is a reflection V is one too: the modes do not notice.
  const double r = std::sqrt(0.5);
  std::array<Matrix2d, 4> modes;
  modes[0] << m.c, 0, 0, m.s;
  modes[1] << -m.s, 0, 0, m.c;
  modes[2] << 0, r, r, 0;
  modes[3] << 0, -r, r, 0;
  Eigen::Matrix<double, 4, 6> w;
  for (int k = 0; k < 4; ++k) {
    const Matrix2d mode = svd.matrixU() * modes[static_cast<std::size_t>(k)] * svd.matrixV().transpose();
    for (int i = 0; i < 3; ++i) {
      const Vector2d along = mode * hat.row(i).transpose(); // in the triangle's plane
      const sphere::TangentFrame frame(q[static_cast<std::size_t>(i)]);
      const Eigen::Vector3d in_space = along.x() * px + along.y() * py;
      w.block<1, 2>(k, 2 * i) = std::sqrt(area * m.lambda[static_cast<std::size_t>(k)]) *
                                Vector2d(in_space.dot(eigen(frame.x)), in_space.dot(eigen(frame.y))).transpose();
    }
  }
  return w.transpose() * w;
}

// The exact 6 x 6 block. D = sum cot_k (1 - p_i . p_j) and V = det(p_0, p_1, p_2) are linear in each corner.
Matrix6d exact_block_of(const std::array<Vec3d, 3>& q, const sphere::Reference& reference) {
  std::array<Eigen::Vector3d, 3> p, dD, dV;
  std::array<Eigen::Matrix<double, 3, 2>, 3> frame;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = eigen(q[i]);
    const sphere::TangentFrame f(q[i]);
    frame[i] << eigen(f.x), eigen(f.y);
  }
  double D = 0;
  for (std::size_t k = 0; k < 3; ++k) D += 0.5 * reference.cot[k] * (p[(k + 1) % 3] - p[(k + 2) % 3]).squaredNorm();
  const double V = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]);
  const auto [h, h1, h2] = sphere::SymmetricDirichlet{}.jet(V, double{reference.area});
  Eigen::Matrix<double, 6, 1> gD, gV;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    dD[i] = -double{reference.cot[k]} * p[j] - double{reference.cot[j]} * p[k];
    dV[i] = p[j].cross(p[k]);
    gD.segment<2>(2 * static_cast<int>(i)) = frame[i].transpose() * dD[i];
    gV.segment<2>(2 * static_cast<int>(i)) = frame[i].transpose() * dV[i];
  }
  Matrix6d out = h1 * (gD * gV.transpose() + gV * gD.transpose()) + D * h2 * gV * gV.transpose();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const int a = 2 * static_cast<int>(i), b = 2 * static_cast<int>(j);
    out.block<2, 2>(a, a) += (-h * dD[i].dot(p[i]) - D * h1 * V) * Matrix2d::Identity();
    Eigen::Matrix3d skew; // u^T skew v = det(u, v, p_k)
    skew << 0, p[k].z(), -p[k].y(), -p[k].z(), 0, p[k].x(), p[k].y(), -p[k].x(), 0;
    const Matrix2d mixed =
        frame[i].transpose() * (-h * double{reference.cot[k]} * Eigen::Matrix3d::Identity() + D * h1 * skew) * frame[j];
    out.block<2, 2>(a, b) += mixed;
    out.block<2, 2>(b, a) += mixed.transpose();
  }
  return out;
}

class Newton {
public:
  Newton(const mesh::TriangleMesh& mesh, std::vector<Vec3d> points)
      : mesh_(mesh), points_(std::move(points)), pool_(1) {
    sphere::compute_references(mesh::unit_positions(mesh), mesh.triangles, fine_regularisation, pool_, references_);
    stars_.build(mesh.triangles, points_.size(), pool_);
    energy_ = energy_of(points_);
  }

  // Returns the part of the energy that the quadratic model promises, and takes the step, shortened as far as need be.
  double step() {
    if (share_ > 0) --share_; // of the exact Hessian one notch more than last time
    while (!factorise() && share_ + 1 < shares.size()) ++share_;
    const Eigen::VectorXd gradient = gradient_of(), d = -solver_.solve(gradient);
    const double promise = -0.5 * gradient.dot(d) / energy_;
    const std::vector<Vec3d> start = points_;
    std::vector<Vec3d> trial(points_.size());
    const double before = energy_;
    double t = longest_step;
    for (int i = 0; i < most_halvings; ++i, t *= 0.5) {
      for (std::size_t v = 0; v < start.size(); ++v) {
        const sphere::TangentFrame f(start[v]);
        const auto k = static_cast<Eigen::Index>(2 * v);
        trial[v] = normalized(start[v] + (t * d[k]) * f.x + (t * d[k + 1]) * f.y);
      }
      const double now = energy_of(trial);
      if (now < energy_) { // so far the best length; half of it may be better
        energy_ = now;
        points_ = trial;
      } else if (energy_ < before) {
        break;
      }
    }
    return promise;
  }

  // A fold cuts a step short for the sake of one place: the vertices there go on by themselves.
  void sweep() {
    sphere::SweepOrder order;
    order.build(stars_, pool_);
    sphere::Active active(points_.size(), 1);
    for (int i = 0; i < 20; ++i) {
      sphere::relax_active({stars_, references_, order}, sphere::SymmetricDirichlet{}, 1e-3, points_, active, pool_);
    }
    energy_ = energy_of(points_);
  }

  [[nodiscard]] double energy() const { return energy_; }
  [[nodiscard]] std::vector<Vec3d> points() && { return std::move(points_); }

private:
  double energy_of(std::span<const Vec3d> points) {
    return sphere::total_energy(sphere::SymmetricDirichlet{}, mesh_.triangles, references_, points, pool_);
  }

  bool factorise() {
    assemble();
    if (first_) solver_.analyzePattern(matrix_);
    first_ = false;
    solver_.factorize(matrix_);
    return solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0;
  }

  void assemble() {
    entries_.clear();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const mesh::Triangle& v = mesh_.triangles[t];
      const std::array<Vec3d, 3> q{points_[v[0]], points_[v[1]], points_[v[2]]};
      const double share = shares[share_];
      Matrix6d block = (1 - share) * convex_block_of(q, references_[t]) + share * exact_block_of(q, references_[t]);
      block.diagonal().array() += shift * double{references_[t].area} / 3;
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
          const auto row = static_cast<int>(2 * v[static_cast<std::size_t>(i / 2)]) + i % 2;
          const auto column = static_cast<int>(2 * v[static_cast<std::size_t>(j / 2)]) + j % 2;
          if (row >= column) entries_.emplace_back(row, column, block(i, j));
        }
      }
    }
    const auto n = static_cast<Eigen::Index>(2 * points_.size());
    matrix_.resize(n, n);
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
  }

  Eigen::VectorXd gradient_of() {
    std::vector<sphere::Tangent> gradient(points_.size());
    sphere::tangent_gradient(sphere::SymmetricDirichlet{}, stars_, references_, points_, gradient, pool_);
    Eigen::VectorXd out(static_cast<Eigen::Index>(2 * points_.size()));
    for (std::size_t v = 0; v < gradient.size(); ++v) {
      out[static_cast<Eigen::Index>(2 * v)] = gradient[v].x;
      out[static_cast<Eigen::Index>(2 * v + 1)] = gradient[v].y;
    }
    return out;
  }

  const mesh::TriangleMesh& mesh_;
  std::vector<Vec3d> points_;
  mesh::ThreadPool pool_;
  std::vector<sphere::Reference> references_;
  sphere::StarTable stars_;
  double energy_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
  Sparse matrix_;
  Eigen::SimplicialLDLT<Sparse> solver_;
  bool first_ = true;
  std::size_t share_ = 2;
};

} // namespace

Reference converge(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& points, int most_steps) {
  Newton newton(mesh, points);
  Reference out;
  out.energy_before = newton.energy();
  while (!out.converged && out.steps < most_steps) {
    out.converged = newton.step() < enough;
    newton.sweep();
    ++out.steps;
  }
  out.energy_after = newton.energy();
  out.points = std::move(newton).points();
  return out;
}

} // namespace orbis::bench
