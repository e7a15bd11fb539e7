#include "core/texture/plane_newton.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/texture/area_factor.h"

namespace orbis::texture {
namespace {

constexpr double worthwhile = 1e-3; // of the energy, for a round
constexpr int sweeps_a_round = 5;
constexpr std::size_t small = 10'000; // triangles
constexpr int rounds = 20, rounds_if_small = 200;
constexpr double regularisation = 1e-9; // of the Hessian's mean diagonal
constexpr double sufficient = 1e-4;     // of what the gradient promises (Armijo)
constexpr double part_to_fold = 0.9;
constexpr int most_halvings = 20;
constexpr int fixed = -1;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Corner = std::array<int, 2>; // the variables of a point's x and y

// Of one triangle, by the coordinates of its edges a - p and b - p: (ux, uy, vx, vy).
struct Local {
  Eigen::Vector4d gradient;
  Eigen::Matrix4d hessian;
};

Local local_expansion(const PlaneReference& r, int exponent, const FlatPoint& p, const FlatPoint& a,
                      const FlatPoint& b) {
  const Eigen::Vector4d e{a.x - p.x, a.y - p.y, b.x - p.x, b.y - p.y};
  // D = 1/2 (cot_b |u|^2 + cot_a |v|^2 + cot_p |u - v|^2)
  const double uu = r.cot[2] + r.cot[0], vv = r.cot[1] + r.cot[0], uv = -r.cot[0];
  Eigen::Matrix4d L;
  L << uu, 0, uv, 0, 0, uu, 0, uv, uv, 0, vv, 0, 0, uv, 0, vv;
  const Eigen::Vector4d Dz = L * e;
  const double D = 0.5 * e.dot(Dz), scale = 0.5 / r.area;
  // x = (uy vx - ux vy) / (2 A)
  const Eigen::Vector4d xz = scale * Eigen::Vector4d{-e[3], e[2], e[1], -e[0]};
  Eigen::Matrix4d xzz = Eigen::Matrix4d::Zero();
  xzz(0, 3) = xzz(3, 0) = -scale;
  xzz(1, 2) = xzz(2, 1) = scale;
  const AreaFactor f(scale * (e[1] * e[2] - e[0] * e[3]), exponent);
  Local out;
  out.gradient = f.h * Dz + D * f.h1 * xz;
  out.hessian =
      f.h * L + f.h1 * (Dz * xz.transpose() + xz * Dz.transpose()) + D * f.h2 * xz * xz.transpose() + D * f.h1 * xzz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> modes(out.hessian);
  out.hessian =
      modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).asDiagonal() * modes.eigenvectors().transpose();
  return out;
}

class Newton {
public:
  explicit Newton(PlaneMesh& mesh) : mesh_(mesh), variables_(mesh.points.size()) {
    double width = 0, height = 0;
    for (const FlatPoint& p : mesh.points) {
      width = std::max(width, p.x);
      height = std::max(height, p.y);
    }
    int count = 2;
    for (std::size_t v = 0; v < variables_.size(); ++v) {
      const FlatPoint& p = mesh.points[v];
      variables_[v][0] = mesh.fixed_x[v] ? (p.x > 0.5 * width ? 0 : fixed) : count++;
      variables_[v][1] = mesh.fixed_y[v] ? (p.y > 0.5 * height ? 1 : fixed) : count++;
    }
    gradient_.resize(count);
  }

  // Leaves the mesh as it is where there is no way down.
  void step() {
    assemble();
    if (!is_analysed_) solver_.analyzePattern(hessian_);
    is_analysed_ = true;
    solver_.factorize(hessian_);
    if (solver_.info() != Eigen::Success) return;
    const Vector s = -solver_.solve(gradient_);
    const double slope = gradient_.dot(s);
    if (!s.allFinite() || !(slope < 0)) return;
    const std::vector<FlatPoint> before = mesh_.points;
    const double energy = energy_of(mesh_);
    double t = step_to_fold(s);
    for (int i = 0; i < most_halvings; ++i, t *= 0.5) {
      for (std::size_t v = 0; v < before.size(); ++v) {
        const FlatPoint d = along(s, v);
        mesh_.points[v] = {before[v].x + t * d.x, before[v].y + t * d.y};
      }
      if (is_positive() && energy_of(mesh_) < energy + sufficient * t * slope) return;
    }
    mesh_.points = before;
  }

private:
  PlaneMesh& mesh_;
  std::vector<Corner> variables_; // 0 and 1 are the right side's x and the lower side's y
  Vector gradient_;
  Matrix hessian_;
  std::vector<Eigen::Triplet<double, int>> entries_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver_;
  bool is_analysed_ = false;

  [[nodiscard]] FlatPoint along(const Vector& s, std::size_t v) const {
    const auto& [x, y] = variables_[v];
    return {x == fixed ? 0 : s[x], y == fixed ? 0 : s[y]};
  }

  void assemble() {
    gradient_.setZero();
    entries_.clear();
    double trace = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) trace += add(t);
    const double more = regularisation * trace / static_cast<double>(gradient_.size());
    for (int i = 0; i < gradient_.size(); ++i) entries_.emplace_back(i, i, more);
    hessian_.resize(gradient_.size(), gradient_.size());
    hessian_.setFromTriplets(entries_.begin(), entries_.end());
  }

  double add(std::size_t t) {
    const auto& [p, a, b] = mesh_.triangles[t];
    const PlaneReference& r = mesh_.references[t];
    const Local local = local_expansion(r, exponent_of(mesh_, r), mesh_.points[p], mesh_.points[a], mesh_.points[b]);
    // d(ux, uy, vx, vy) / d(px, py, ax, ay, bx, by)
    Eigen::Matrix<double, 4, 6> by_corner = Eigen::Matrix<double, 4, 6>::Zero();
    for (int k = 0; k < 2; ++k) {
      by_corner(k, k) = by_corner(k + 2, k) = -1;
      by_corner(k, k + 2) = by_corner(k + 2, k + 4) = 1;
    }
    const Eigen::Matrix<double, 6, 1> g = by_corner.transpose() * local.gradient;
    const Eigen::Matrix<double, 6, 6> H = by_corner.transpose() * local.hessian * by_corner;
    std::array<int, 6> row{};
    for (std::size_t k = 0; k < 6; ++k) row[k] = variables_[mesh_.triangles[t][k / 2]][k % 2];
    for (int i = 0; i < 6; ++i) {
      const int at = row[static_cast<std::size_t>(i)];
      if (at == fixed) continue;
      gradient_[at] += g[i];
      for (int j = 0; j < 6; ++j)
        if (const int column = row[static_cast<std::size_t>(j)]; column != fixed && column <= at)
          entries_.emplace_back(at, column, H(i, j));
    }
    return H.trace();
  }

  [[nodiscard]] bool is_positive() const {
    return std::ranges::all_of(mesh_.triangles, [&](const mesh::Triangle& t) {
      return doubled_area(mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]) > 0;
    });
  }

  // The largest t in (0, 1] short of the first fold: areas are quadratic along the way.
  [[nodiscard]] double step_to_fold(const Vector& s) const {
    double t = 1;
    for (const auto& [p, a, b] : mesh_.triangles) {
      const FlatPoint dp = along(s, p), da = along(s, a), db = along(s, b);
      const FlatPoint &P = mesh_.points[p], &A = mesh_.points[a], &B = mesh_.points[b];
      const double ux = A.x - P.x, uy = A.y - P.y, vx = B.x - P.x, vy = B.y - P.y;
      const double sx = da.x - dp.x, sy = da.y - dp.y, wx = db.x - dp.x, wy = db.y - dp.y;
      const double c0 = uy * vx - ux * vy, c1 = sy * vx + uy * wx - sx * vy - ux * wy, c2 = sy * wx - sx * wy;
      t = std::min(t, part_to_fold * first_root(c0, c1, c2));
    }
    return t;
  }

  // Of c0 + c1 t + c2 t^2 with c0 > 0, the least positive one; infinite if there is none.
  static double first_root(double c0, double c1, double c2) {
    const double discriminant = c1 * c1 - 4 * c0 * c2;
    if (discriminant < 0 || (c1 >= 0 && c2 >= 0)) return std::numeric_limits<double>::infinity();
    const double root = -c1 + std::sqrt(discriminant);
    return root > 0 ? 2 * c0 / root : std::numeric_limits<double>::infinity();
  }
};

} // namespace

void lower_by_newton(PlaneMesh& mesh) {
  Newton newton(mesh);
  double energy = energy_of(mesh);
  for (int i = mesh.triangles.size() <= small ? rounds_if_small : rounds; i > 0; --i) {
    relax(mesh, sweeps_a_round);
    newton.step();
    const double now = energy_of(mesh);
    if (now > (1 - worthwhile) * energy) return;
    energy = now;
  }
}

} // namespace orbis::texture
