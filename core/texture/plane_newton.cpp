#include "core/texture/plane_newton.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/sphere/triangle_hessian.h"
#include "core/texture/area_factor.h"

namespace orbis::texture {
namespace {

constexpr double worthwhile = 1e-3; // of the energy, for a round
constexpr int sweeps_a_round = 5;
constexpr std::size_t small = 10'000; // triangles
constexpr int rounds = 20, rounds_if_small = 200;
constexpr double regularisation = 1e-9; // of the Hessian's mean diagonal
constexpr double sufficient = 1e-4;     // of what the gradient promises (Armijo)
constexpr double least_singular = 1e-9; // of the larger one
constexpr double part_to_fold = 0.9;
constexpr int most_halvings = 20;
constexpr int fixed = -1;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Corner = std::array<int, 2>; // the variables of a point's x and y

// The area factor as the sphere's energies have theirs (sphere/triangle_energy.h).
struct PlaneFamily {
  int exponent;
  [[nodiscard]] sphere::Jet jet(double V, double area) const {
    const double scale = 0.5 / area;
    const AreaFactor f(scale * V, exponent);
    return {f.h, scale * f.h1, scale * scale * f.h2};
  }
};

// E of one triangle by its six coordinates: the gradient, and the rows w of the Hessian w^T w.
struct Local {
  std::array<double, 6> gradient{};
  std::array<std::array<double, 6>, 4> rows{};
};

// The modes of the second derivative by the map (sphere/energy_modes.h), contracted with the corners' hat functions.
// All in coordinates with y up, in which triangles are counter-clockwise.
Local expand(const PlaneReference& r, int exponent, const std::array<FlatPoint, 3>& corners) {
  std::array<FlatPoint, 3> p = corners;
  for (FlatPoint& corner : p) corner.y = -corner.y;
  const PlaneFamily family{exponent};
  double D = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const FlatPoint &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
    D += 0.5 * r.cot[i] * ((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
  }
  const sphere::HatGradients hat = sphere::hat_gradients(r.cot, r.area);
  std::array<double, 4> F{}; // row-major
  for (std::size_t i = 1; i < 3; ++i) {
    const double x = p[i].x - p[0].x, y = p[i].y - p[0].y;
    F[0] += x * hat.x[i];
    F[1] += x * hat.y[i];
    F[2] += y * hat.x[i];
    F[3] += y * hat.y[i];
  }
  const sphere::Jet h = family.jet(doubled_area(corners[0], corners[1], corners[2]), r.area);
  const sphere::Svd svd = sphere::decompose(F[0], F[1], F[2], F[3]);
  const sphere::Modes modes = sphere::modes_of(family, svd.s1, std::max(svd.s2, least_singular * svd.s1));
  std::array<double, 4> scale{};
  for (std::size_t k = 0; k < 4; ++k) scale[k] = std::sqrt(modes.lambda[k] * r.area);
  const double half = std::sqrt(0.5);
  Local out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double Dx = r.cot[k] * (p[i].x - p[j].x) + r.cot[j] * (p[i].x - p[k].x);
    const double Dy = r.cot[k] * (p[i].y - p[j].y) + r.cot[j] * (p[i].y - p[k].y);
    out.gradient[2 * i] = h.value * Dx + D * h.first * (p[j].y - p[k].y);
    out.gradient[2 * i + 1] = -(h.value * Dy + D * h.first * (p[k].x - p[j].x));
    const double g1 = hat.x[i] * svd.cv + hat.y[i] * svd.sv, g2 = -hat.x[i] * svd.sv + hat.y[i] * svd.cv;
    const std::array<double, 4> along_u1{modes.c * g1, -modes.s * g1, half * g2, -half * g2};
    const std::array<double, 4> along_u2{modes.s * g2, modes.c * g2, half * g1, half * g1};
    for (std::size_t m = 0; m < 4; ++m) {
      out.rows[m][2 * i] = scale[m] * (along_u1[m] * svd.cu - along_u2[m] * svd.su);
      out.rows[m][2 * i + 1] = -scale[m] * (along_u1[m] * svd.su + along_u2[m] * svd.cu);
    }
  }
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
    find_pattern();
  }

  // Leaves the mesh as it is where there is no way down. Returns its energy.
  double step() {
    const double energy = energy_of(mesh_);
    assemble();
    solver_.factorize(hessian_);
    if (solver_.info() != Eigen::Success) return energy;
    const Vector s = -solver_.solve(gradient_);
    const double slope = gradient_.dot(s);
    if (!s.allFinite() || !(slope < 0)) return energy;
    const std::vector<FlatPoint> before = mesh_.points;
    double t = step_to_fold(s);
    for (int i = 0; i < most_halvings; ++i, t *= 0.5) {
      for (std::size_t v = 0; v < before.size(); ++v) {
        const FlatPoint d = along(s, v);
        mesh_.points[v] = {before[v].x + t * d.x, before[v].y + t * d.y};
      }
      if (!is_positive()) continue;
      const double now = energy_of(mesh_);
      if (now < energy + sufficient * t * slope) return now;
    }
    mesh_.points = before;
    return energy;
  }

private:
  PlaneMesh& mesh_;
  std::vector<Corner> variables_; // 0 and 1 are the right side's x and the lower side's y
  Vector gradient_;
  Matrix hessian_;
  std::vector<std::size_t> numbers_; // of the matrix' entries: triangle by triangle, in the order of for_entries()
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver_;

  [[nodiscard]] FlatPoint along(const Vector& s, std::size_t v) const {
    const auto& [x, y] = variables_[v];
    return {x == fixed ? 0 : s[x], y == fixed ? 0 : s[y]};
  }

  // The rows that a triangle has part in, by coordinate.
  [[nodiscard]] std::array<int, 6> rows_of(std::size_t t) const {
    std::array<int, 6> rows{};
    for (std::size_t i = 0; i < 6; ++i) rows[i] = variables_[mesh_.triangles[t][i / 2]][i % 2];
    return rows;
  }

  // visit(entry, i, j) for the entries of the lower triangle that triangle t has part in, by its coordinates.
  template <class Visit> void for_entries(const std::array<int, 6>& rows, Visit visit) const {
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        if (rows[i] != fixed && rows[j] != fixed && rows[i] >= rows[j]) visit(i, j);
  }

  // Which numbers of the sparse matrix they are: looked up once.
  void find_pattern() {
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(static_cast<std::size_t>(gradient_.size()) + 36 * mesh_.triangles.size());
    for (int i = 0; i < gradient_.size(); ++i) entries.emplace_back(i, i, 0.0);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::array<int, 6> rows = rows_of(t);
      for_entries(rows, [&](std::size_t i, std::size_t j) { entries.emplace_back(rows[i], rows[j], 0.0); });
    }
    hessian_.resize(gradient_.size(), gradient_.size());
    hessian_.setFromTriplets(entries.begin(), entries.end());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::array<int, 6> rows = rows_of(t);
      for_entries(rows, [&](std::size_t i, std::size_t j) {
        const int *first = hessian_.innerIndexPtr() + hessian_.outerIndexPtr()[rows[j]],
                  *end = hessian_.innerIndexPtr() + hessian_.outerIndexPtr()[rows[j] + 1];
        numbers_.push_back(static_cast<std::size_t>(std::lower_bound(first, end, rows[i]) - hessian_.innerIndexPtr()));
      });
    }
    solver_.analyzePattern(hessian_);
  }

  void assemble() {
    gradient_.setZero();
    const std::span<double> values(hessian_.valuePtr(), static_cast<std::size_t>(hessian_.nonZeros()));
    std::ranges::fill(values, 0.0);
    std::size_t next = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const PlaneReference& r = mesh_.references[t];
      const auto& [a, b, c] = mesh_.triangles[t];
      const Local local = expand(r, exponent_of(mesh_, r), {mesh_.points[a], mesh_.points[b], mesh_.points[c]});
      const std::array<int, 6> rows = rows_of(t);
      for (std::size_t i = 0; i < 6; ++i)
        if (rows[i] != fixed) gradient_[rows[i]] += local.gradient[i];
      for_entries(rows, [&](std::size_t i, std::size_t j) {
        double sum = 0;
        for (const std::array<double, 6>& w : local.rows) sum += w[i] * w[j];
        values[numbers_[next++]] += sum;
      });
    }
    const double more = regularisation * hessian_.diagonal().mean();
    for (int i = 0; i < gradient_.size(); ++i)
      values[static_cast<std::size_t>(hessian_.outerIndexPtr()[i])] += more; // the first of its column
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
    const double now = newton.step();
    if (now > (1 - worthwhile) * energy) return;
    energy = now;
  }
}

} // namespace orbis::texture
