#include "core/texture/harmonic.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace orbis::texture {
namespace {

constexpr double least_weight = 1e-5, largest_weight = 1e5; // of an edge
constexpr int rows_to_factor = 20'000;                      // more are solved in steps
constexpr double accuracy = 1e-7;                           // of the residual, in units of the right side
constexpr int most_steps = 300;
constexpr double points_a_cell = 32; // of the coarse grid, about
constexpr int widest_grid = 128;

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
using Cholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double, Eigen::ColMajor, int>, Eigen::Lower>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>; // x and y
using Entries = std::vector<Eigen::Triplet<double, int>>;

// Values at the nodes of a grid over the points' first places, taken to the points bilinearly.
Matrix interpolation(std::span<const FlatPoint> points) {
  double low_x = points[0].x, low_y = points[0].y, high_x = low_x, high_y = low_y;
  for (const FlatPoint& p : points) {
    low_x = std::min(low_x, p.x);
    high_x = std::max(high_x, p.x);
    low_y = std::min(low_y, p.y);
    high_y = std::max(high_y, p.y);
  }
  const auto rows = static_cast<int>(points.size());
  const int cells = std::clamp(static_cast<int>(std::sqrt(rows / points_a_cell)), 1, widest_grid);
  const auto scale = [cells](double low, double high) { return high > low ? cells / (high - low) : 0.0; };
  const double scale_x = scale(low_x, high_x), scale_y = scale(low_y, high_y);
  Entries entries;
  entries.reserve(4 * points.size());
  for (int i = 0; i < rows; ++i) {
    const FlatPoint& p = points[static_cast<std::size_t>(i)];
    const double x = scale_x * (p.x - low_x), y = scale_y * (p.y - low_y);
    const int column = std::min(static_cast<int>(x), cells - 1), row = std::min(static_cast<int>(y), cells - 1);
    const double u = x - column, v = y - row;
    const int node = row * (cells + 1) + column;
    entries.emplace_back(i, node, (1 - u) * (1 - v));
    entries.emplace_back(i, node + 1, u * (1 - v));
    entries.emplace_back(i, node + cells + 1, (1 - u) * v);
    entries.emplace_back(i, node + cells + 2, u * v);
  }
  Matrix out(rows, (cells + 1) * (cells + 1));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// One step of two grids for A x = b: a sweep of Gauss and Seidel, the grid's own system, the sweep back. Symmetric and
// positive, as conjugate gradients need it.
class TwoGrids {
public:
  TwoGrids(const Matrix& matrix, std::span<const FlatPoint> points)
      : matrix_(matrix), diagonal_(matrix.diagonal()), up_(interpolation(points)), down_(up_.transpose()) {
    const Matrix coarse = down_ * (matrix_ * up_);
    // Nodes without a point near them have no equation of their own.
    Matrix more(coarse.rows(), coarse.rows());
    more.setIdentity();
    cholesky_.compute(coarse + 1e-10 * coarse.diagonal().maxCoeff() * more);
  }

  [[nodiscard]] bool is_sound() const { return cholesky_.info() == Eigen::Success; }

  [[nodiscard]] Columns operator()(const Columns& right) const {
    Columns x = Columns::Zero(right.rows(), 2);
    for (int i = 0; i < matrix_.rows(); ++i) relax(i, right, x);
    const Columns rest = down_ * (right - matrix_ * x);
    x += up_ * Columns(cholesky_.solve(rest));
    for (int i = static_cast<int>(matrix_.rows()) - 1; i >= 0; --i) relax(i, right, x);
    return x;
  }

private:
  const Matrix& matrix_;
  Eigen::VectorXd diagonal_;
  Matrix up_, down_;
  Cholesky cholesky_;

  void relax(int i, const Columns& right, Columns& x) const {
    double rest_x = right(i, 0), rest_y = right(i, 1);
    for (Matrix::InnerIterator a(matrix_, i); a; ++a) {
      rest_x -= a.value() * x(a.col(), 0);
      rest_y -= a.value() * x(a.col(), 1);
    }
    x(i, 0) += rest_x / diagonal_[i];
    x(i, 1) += rest_y / diagonal_[i];
  }
};

// Conjugate gradients for both columns side by side (Hestenes and Stiefel 1952), with two grids in front.
bool solve_in_steps(const Matrix& matrix, const Columns& right, std::span<const FlatPoint> points, Columns& x) {
  const TwoGrids precondition(matrix, points);
  if (!precondition.is_sound()) return false;
  const auto dot = [](const Columns& a, const Columns& b) -> Eigen::RowVector2d {
    return a.cwiseProduct(b).colwise().sum();
  };
  Columns rest = right - matrix * x, z = precondition(rest), direction = z;
  Eigen::RowVector2d old = dot(rest, z);
  const double enough = accuracy * right.norm();
  for (int step = 0; step < most_steps; ++step) {
    if (rest.norm() <= enough) return true;
    const Columns image = matrix * direction;
    const Eigen::RowVector2d curvature = dot(direction, image);
    if (!(curvature.minCoeff() > 0)) return false;
    const Eigen::RowVector2d length = old.cwiseQuotient(curvature);
    x += direction * length.asDiagonal();
    rest -= image * length.asDiagonal();
    z = precondition(rest);
    const Eigen::RowVector2d now = dot(rest, z);
    direction = z + direction * now.cwiseQuotient(old).asDiagonal();
    old = now;
  }
  return false;
}

class Harmonic {
public:
  explicit Harmonic(PlaneMesh& mesh) : mesh_(mesh), row_(mesh.points.size(), on_side) {
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
      if (mesh.fixed_x[p] || mesh.fixed_y[p]) continue;
      row_[p] = rows_++;
      points_.push_back(mesh.points[p]);
    }
  }

  bool run() {
    if (rows_ == 0) return true;
    assemble();
    Columns places = Columns::Constant(rows_, 2, 0.5);
    if (!(rows_ <= rows_to_factor ? factor(places) : solve_in_steps(matrix_, right_, points_, places))) return false;
    if (!places.allFinite()) return false;
    for (std::size_t p = 0; p < row_.size(); ++p)
      if (row_[p] != on_side) mesh_.points[p] = {places(row_[p], 0), places(row_[p], 1)};
    return true;
  }

private:
  static constexpr int on_side = -1;

  PlaneMesh& mesh_;
  std::vector<int> row_; // of each point in the system
  int rows_ = 0;
  std::vector<FlatPoint> points_; // by row
  Matrix matrix_;
  Columns right_;

  // Each triangle adds its half of an edge's weight: half the cotangent, kept positive.
  void assemble() {
    Entries entries;
    right_ = Columns::Zero(rows_, 2);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const mesh::Index a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        const double w = std::clamp(0.5 * mesh_.references[t].cot[(k + 2) % 3], least_weight, largest_weight);
        join(a, b, w, entries);
        join(b, a, w, entries);
      }
    matrix_.resize(rows_, rows_);
    matrix_.setFromTriplets(entries.begin(), entries.end());
  }

  void join(mesh::Index a, mesh::Index b, double w, Entries& entries) {
    const int i = row_[a], j = row_[b];
    if (i == on_side) return;
    entries.emplace_back(i, i, w);
    if (j == on_side) {
      right_(i, 0) += w * mesh_.points[b].x;
      right_(i, 1) += w * mesh_.points[b].y;
    } else {
      entries.emplace_back(i, j, -w);
    }
  }

  [[nodiscard]] bool factor(Columns& places) const {
    const Cholesky cholesky(matrix_);
    if (cholesky.info() != Eigen::Success) return false;
    places = cholesky.solve(right_);
    return true;
  }
};

} // namespace

bool lay_harmonically(PlaneMesh& mesh) { return Harmonic(mesh).run(); }

} // namespace orbis::texture
