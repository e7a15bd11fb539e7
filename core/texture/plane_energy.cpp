#include "core/texture/plane_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/texture/area_factor.h"
#include "core/texture/stars.h"

namespace orbis::texture {
namespace {

constexpr int most_halvings = 6;
constexpr double worthwhile = 0.01;          // of a star's energy
constexpr double smallest_eigenvalue = 1e-3; // in units of the largest one

// A triangle (p, a, b) of the star of p.
struct Term {
  FlatPoint a, b;
  double cot_a, cot_b; // at a (opposite the edge p b) and at b (opposite p a)
  double fixed;        // 1/2 cot_p |a - b|^2
  double scale;        // 1 / (2 A)
  int exponent;
};

double squared(double x, double y) { return x * x + y * y; }

struct Expansion {
  double energy = 0, gx = 0, gy = 0, hxx = 0, hxy = 0, hyy = 0;
};

// With the other corners fixed V is linear in p and D quadratic.
Expansion expand(std::span<const Term> star, const FlatPoint& p) {
  Expansion out;
  for (const Term& t : star) {
    const double ux = t.a.x - p.x, uy = t.a.y - p.y, vx = t.b.x - p.x, vy = t.b.y - p.y;
    const double D = 0.5 * (t.cot_b * squared(ux, uy) + t.cot_a * squared(vx, vy)) + t.fixed;
    const double Dx = -(t.cot_b * ux + t.cot_a * vx), Dy = -(t.cot_b * uy + t.cot_a * vy);
    const double Dxx = t.cot_a + t.cot_b;
    const AreaFactor f(t.scale * (uy * vx - ux * vy), t.exponent);
    const double Vx = t.scale * (vy - uy), Vy = t.scale * (ux - vx);
    out.energy += D * f.h;
    out.gx += f.h * Dx + D * f.h1 * Vx;
    out.gy += f.h * Dy + D * f.h1 * Vy;
    out.hxx += f.h * Dxx + 2 * f.h1 * Dx * Vx + D * f.h2 * Vx * Vx;
    out.hyy += f.h * Dxx + 2 * f.h1 * Dy * Vy + D * f.h2 * Vy * Vy;
    out.hxy += f.h1 * (Dx * Vy + Dy * Vx) + D * f.h2 * Vx * Vy;
  }
  return out;
}

// Infinite where a triangle is folded.
double energy_at(std::span<const Term> star, const FlatPoint& p) {
  double sum = 0;
  for (const Term& t : star) {
    const double ux = t.a.x - p.x, uy = t.a.y - p.y, vx = t.b.x - p.x, vy = t.b.y - p.y;
    const double x = t.scale * (uy * vx - ux * vy);
    if (!(x > 0)) return std::numeric_limits<double>::infinity();
    sum += (0.5 * (t.cot_b * squared(ux, uy) + t.cot_a * squared(vx, vy)) + t.fixed) * AreaFactor::at(x, t.exponent);
  }
  return sum;
}

// -H^-1 g with the eigenvalues of H replaced by their magnitudes, none below a part of the largest.
FlatPoint descent(const Expansion& e) {
  const double mean = 0.5 * (e.hxx + e.hyy), half = 0.5 * (e.hxx - e.hyy);
  const double radius = std::sqrt(half * half + e.hxy * e.hxy);
  double large = std::abs(mean + radius), small = std::abs(mean - radius);
  const double floor = smallest_eigenvalue * std::max(large, small);
  if (!(floor > 0)) return {};
  large = std::max(large, floor);
  small = std::max(small, floor);
  // The eigenvector of mean + radius has half the angle of (half, hxy): its larger component by the half-angle formula,
  // the other one by that of the sine, free of cancellation.
  double ex = 1, ey = 0;
  if (radius > 0) {
    const double larger = std::sqrt(0.5 * (1 + std::abs(half) / radius)), smaller = 0.5 * e.hxy / (radius * larger);
    ex = half >= 0 ? larger : smaller;
    ey = half >= 0 ? smaller : larger;
  }
  const double along = (e.gx * ex + e.gy * ey) / large, across = (e.gy * ex - e.gx * ey) / small;
  return {-(along * ex - across * ey), -(along * ey + across * ex)};
}

FlatPoint along_side(const Expansion& e, bool fixed_x, bool fixed_y) {
  const auto step = [](double g, double h) { return h != 0 ? -g / std::abs(h) : 0.0; };
  return {fixed_x ? 0 : step(e.gx, e.hxx), fixed_y ? 0 : step(e.gy, e.hyy)};
}

// The largest t in (0, 1] that leaves every triangle at least a tenth of its area.
double step_to_fold(std::span<const Term> star, const FlatPoint& p, const FlatPoint& s) {
  double t = 1;
  for (const Term& term : star) {
    const double V = doubled_area(p, term.a, term.b);
    const double slope = s.x * (term.b.y - term.a.y) + s.y * (term.a.x - term.b.x);
    if (V + t * slope < 0.1 * V) t = std::min(t, -0.9 * V / slope);
  }
  return t;
}

class Relaxation {
public:
  explicit Relaxation(PlaneMesh& mesh) : mesh_(mesh), awake_(mesh.points.size(), 1) {
    stars_ = Stars(mesh.triangles, mesh.points.size());
  }

  // Returns whether any point moved by what is worthwhile.
  bool sweep() {
    bool any = false;
    for (mesh::Index v = 0; v < mesh_.points.size(); ++v) {
      if (awake_[v] == 0 || (mesh_.fixed_x[v] && mesh_.fixed_y[v])) continue;
      awake_[v] = 0;
      if (!(move(v) > worthwhile)) continue;
      any = true;
      awake_[v] = 1;
      for (const StarCorner& c : stars_[v]) awake_[c.next] = awake_[c.previous] = 1;
    }
    return any;
  }

private:
  PlaneMesh& mesh_;
  Stars stars_;
  std::vector<std::uint8_t> awake_;
  std::vector<Term> star_;

  void gather(mesh::Index v) {
    star_.clear();
    for (const StarCorner& c : stars_[v]) {
      const PlaneReference& r = mesh_.references[c.corner / 3];
      const std::size_t k = c.corner % 3;
      const FlatPoint &a = mesh_.points[c.next], &b = mesh_.points[c.previous];
      star_.push_back({a, b, r.cot[(k + 1) % 3], r.cot[(k + 2) % 3], 0.5 * r.cot[k] * squared(a.x - b.x, a.y - b.y),
                       0.5 / r.area, exponent_of(mesh_, r)});
    }
  }

  // Returns the part of the star's energy that was gained.
  double move(mesh::Index v) {
    gather(v);
    FlatPoint& p = mesh_.points[v];
    const Expansion e = expand(star_, p);
    const bool on_side = mesh_.fixed_x[v] || mesh_.fixed_y[v];
    const FlatPoint s = on_side ? along_side(e, mesh_.fixed_x[v], mesh_.fixed_y[v]) : descent(e);
    double t = step_to_fold(star_, p, s);
    if (!(t > 0)) return 0;
    for (int i = 0; i < most_halvings; ++i, t *= 0.5) {
      const FlatPoint q{p.x + t * s.x, p.y + t * s.y};
      const double energy = energy_at(star_, q);
      if (!(energy < e.energy)) continue;
      p = q;
      return (e.energy - energy) / e.energy;
    }
    return 0;
  }
};

// The energy of triangles of one exponent as a function of the mesh's scales along x and y: D = sx^2 Dx + sy^2 Dy and
// x = sx sy x0, so E is a sum of moments of Dx and of Dy with the powers of x0 that h has.
class Moments {
public:
  // h = (x + 1/x)^n / (2^(n+1) x), by the binomial theorem.
  explicit Moments(int exponent) : n_(exponent), factors_{std::ldexp(1.0, -n_ - 1)} {
    for (int k = 1; k <= n_; ++k) factors_.push_back(factors_.back() * (n_ + 1 - k) / k);
    of_x_.resize(factors_.size());
    of_y_.resize(factors_.size());
  }

  void add(double x, double along_x, double along_y) {
    double x_power = std::pow(x, n_ - 1);
    for (std::size_t i = 0; i < factors_.size(); ++i, x_power /= x * x) {
      of_x_[i] += along_x * x_power;
      of_y_[i] += along_y * x_power;
    }
  }

  [[nodiscard]] double energy(double sx, double sy) const {
    const double s = sx * sy;
    double s_power = std::pow(s, n_ - 1), sum = 0;
    for (std::size_t i = 0; i < factors_.size(); ++i, s_power /= s * s)
      sum += factors_[i] * s_power * (sx * sx * of_x_[i] + sy * sy * of_y_[i]);
    return sum;
  }

private:
  int n_;
  std::vector<double> factors_, of_x_, of_y_; // by power of x: n - 1, n - 3, ...
};

class ScaledEnergy {
public:
  explicit ScaledEnergy(const PlaneMesh& mesh) : surface_(mesh.exponent), holes_(exponent_of_holes) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const PlaneReference& r = mesh.references[t];
      std::array<FlatPoint, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.points[mesh.triangles[t][k]];
      double along_x = 0, along_y = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const FlatPoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
        along_x += 0.5 * r.cot[k] * (a.x - b.x) * (a.x - b.x);
        along_y += 0.5 * r.cot[k] * (a.y - b.y) * (a.y - b.y);
      }
      (r.closes_hole ? holes_ : surface_).add(doubled_area(p[0], p[1], p[2]) / (2 * r.area), along_x, along_y);
    }
  }

  [[nodiscard]] double operator()(double sx, double sy) const {
    return surface_.energy(sx, sy) + holes_.energy(sx, sy);
  }

private:
  Moments surface_, holes_;
};

} // namespace

PlaneReference plane_reference(const Vec3d& p0, const Vec3d& p1, const Vec3d& p2) {
  constexpr double regularisation = 1e-5;
  // With d added to the squared lengths of a triangle of area A, Heron's formula gives
  // 16 A'^2 = 16 A^2 + 2 d (l0 + l1 + l2) + 3 d^2, free of cancellation.
  const double l0 = squared_norm(p2 - p1), l1 = squared_norm(p0 - p2), l2 = squared_norm(p1 - p0);
  const double sum = l0 + l1 + l2, d = regularisation * sum / 3;
  const double four_areas = std::sqrt(4 * squared_norm(cross(p1 - p0, p2 - p0)) + 2 * d * sum + 3 * d * d);
  if (!(four_areas > 0)) return {{std::numbers::inv_sqrt3, std::numbers::inv_sqrt3, std::numbers::inv_sqrt3}, 0};
  const auto cot = [&](double opposite) { return (sum + d - 2 * opposite) / four_areas; };
  return {{cot(l0), cot(l1), cot(l2)}, four_areas / 4};
}

double energy_of(const PlaneMesh& mesh) { return ScaledEnergy(mesh)(1, 1); }

void relax(PlaneMesh& mesh, int sweeps) {
  Relaxation relaxation(mesh);
  for (int i = 0; i < sweeps; ++i)
    if (!relaxation.sweep()) return;
}

void stretch_to_best(PlaneMesh& mesh) {
  const ScaledEnergy energy(mesh);
  double sx = 1, sy = 1, best = energy(sx, sy);
  // Pattern search over the logarithms, on sums of six numbers.
  for (double step = 1; step > 1e-4;) {
    bool better = false;
    for (const auto& [dx, dy] : {std::pair{1, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const double x = sx * std::exp(step * dx), y = sy * std::exp(step * dy), e = energy(x, y);
      if (!(e < best)) continue;
      sx = x;
      sy = y;
      best = e;
      better = true;
    }
    if (!better) step *= 0.5;
  }
  for (FlatPoint& p : mesh.points) {
    p.x *= sx;
    p.y *= sy;
  }
}

} // namespace orbis::texture
