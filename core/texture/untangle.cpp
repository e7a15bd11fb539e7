// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov: Foldover-free maps in 50 lines of code (2021): with
// chi(V) = (V + sqrt(V^2 + e^2)) / 2 in the place of V, D / chi(V) is finite for folded triangles too, and falls as
// they open; e goes to 0 with the worst of them.
#include "core/texture/untangle.h"

#include <algorithm>
#include <cmath>

#include "core/texture/stars.h"

namespace orbis::texture {
namespace {

constexpr int rounds = 10;
constexpr double thin = 1e-3; // a triangle with less of its area counts as folded
constexpr int rings = 3;      // around the folded triangles
constexpr double smallest_e = 0.01;

double chi(double x, double e) { return 0.5 * (x + std::sqrt(x * x + e * e)); }

class Untangler {
public:
  explicit Untangler(PlaneMesh& mesh) : mesh_(mesh) {}

  bool run() {
    std::vector<std::uint32_t> folds = folded();
    if (folds.empty()) return true;
    stars_ = Stars(mesh_.triangles, mesh_.points.size());
    for (int round = 0; round < rounds && !folds.empty(); ++round) {
      const std::vector<mesh::Index> movable = around(folds);
      double worst = 0;
      for (const std::uint32_t t : folds) worst = std::min(worst, ratio(t));
      const double e = std::max(smallest_e, std::min(-0.3 * worst, 10.0));
      for (const mesh::Index v : movable) improve(v, e);
      folds = folded();
    }
    return std::all_of(folds.begin(), folds.end(), [this](std::uint32_t t) { return ratio(t) > 0; });
  }

private:
  PlaneMesh& mesh_;
  Stars stars_;

  [[nodiscard]] double ratio(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return doubled_area(mesh_.points[a], mesh_.points[b], mesh_.points[c]) / (2 * mesh_.references[t].area);
  }

  [[nodiscard]] std::vector<std::uint32_t> folded() const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (!(ratio(t) > thin)) out.push_back(t);
    return out;
  }

  // The points within a few rings of the folds, nearest first.
  [[nodiscard]] std::vector<mesh::Index> around(const std::vector<std::uint32_t>& folds) const {
    std::vector<bool> known(mesh_.points.size(), false);
    std::vector<mesh::Index> out;
    const auto add = [&](mesh::Index v) {
      if (!known[v]) out.push_back(v);
      known[v] = true;
    };
    for (const std::uint32_t t : folds) std::for_each(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), add);
    for (std::size_t ring = 0, first = 0; ring < rings; ++ring) {
      const std::size_t end = out.size();
      for (; first < end; ++first)
        for (const StarCorner& c : stars_[out[first]]) add(c.next);
    }
    return out;
  }

  [[nodiscard]] double energy(mesh::Index v, const FlatPoint& p, double e) const {
    double sum = 0;
    for (const StarCorner& c : stars_[v]) {
      const PlaneReference& r = mesh_.references[c.corner / 3];
      const std::size_t k = c.corner % 3;
      const FlatPoint &a = mesh_.points[c.next], &b = mesh_.points[c.previous];
      const auto squared = [](const FlatPoint& i, const FlatPoint& j) {
        return (i.x - j.x) * (i.x - j.x) + (i.y - j.y) * (i.y - j.y);
      };
      const double D =
          0.5 * (r.cot[k] * squared(a, b) + r.cot[(k + 1) % 3] * squared(p, b) + r.cot[(k + 2) % 3] * squared(p, a));
      const double x = doubled_area(p, a, b) / (2 * r.area), y = chi(x, e);
      // Areas count too, or an opened triangle would grow without end.
      sum += D / y + r.area * x * x;
    }
    return sum;
  }

  // One Newton step from central differences; the step is halved until the energy falls.
  void improve(mesh::Index v, double e) {
    if (mesh_.fixed_x[v] && mesh_.fixed_y[v]) return;
    FlatPoint& p = mesh_.points[v];
    double size = 0;
    for (const StarCorner& c : stars_[v])
      size = std::max(size, std::hypot(mesh_.points[c.next].x - p.x, mesh_.points[c.next].y - p.y));
    const double d = 1e-3 * size, here = energy(v, p, e);
    if (!(d > 0)) return;
    const auto at = [&](double x, double y) { return energy(v, {p.x + d * x, p.y + d * y}, e); };
    const double right = at(1, 0), left = at(-1, 0), down = at(0, 1), up = at(0, -1);
    const double gx = 0.5 * (right - left), gy = 0.5 * (down - up);
    const double hxx = right - 2 * here + left, hyy = down - 2 * here + up;
    const double hxy = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
    FlatPoint s = step(gx, gy, hxx, hxy, hyy, mesh_.fixed_x[v], mesh_.fixed_y[v]);
    const double length = std::hypot(s.x, s.y), longest = 0.5 / 1e-3; // half the star
    double t = length > longest ? longest / length : 1;
    for (int i = 0; i < 8; ++i, t *= 0.5) {
      const FlatPoint q{p.x + d * t * s.x, p.y + d * t * s.y};
      if (!(energy(v, q, e) < here)) continue;
      p = q;
      return;
    }
  }

  static FlatPoint step(double gx, double gy, double hxx, double hxy, double hyy, bool fixed_x, bool fixed_y) {
    const auto along = [](double g, double h) { return h != 0 ? -g / std::abs(h) : -g; };
    if (fixed_x) return {0, along(gy, hyy)};
    if (fixed_y) return {along(gx, hxx), 0};
    const double det = hxx * hyy - hxy * hxy;
    if (det > 1e-6 * (hxx * hxx + hyy * hyy) && hxx > 0)
      return {-(hyy * gx - hxy * gy) / det, -(hxx * gy - hxy * gx) / det};
    const double h = std::hypot(hxx, hyy) + std::abs(hxy);
    return h > 0 ? FlatPoint{-gx / h, -gy / h} : FlatPoint{};
  }
};

} // namespace

bool untangle(PlaneMesh& mesh) {
  const std::vector<FlatPoint> before = mesh.points;
  if (Untangler(mesh).run()) return true;
  // What was only thin is better than what became folded.
  const bool was_sound = std::ranges::all_of(mesh.triangles, [&](const mesh::Triangle& t) {
    return doubled_area(before[t[0]], before[t[1]], before[t[2]]) > 0;
  });
  if (was_sound) mesh.points = before;
  return was_sound;
}

} // namespace orbis::texture
