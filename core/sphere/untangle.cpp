#include "core/sphere/untangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "core/sphere/distortion_energy.h"

namespace orbis::sphere {
namespace {

using mesh::Index;

constexpr std::size_t grain = 8192;
// eps in units of the areas around a vertex before the step: from half of them down.
constexpr double first_eps = 0.5, eps_factor = 0.4;
constexpr int rounds = 8, sweeps = 6, last_sweeps = 4;
// A round that leaves more than this part of the folds hardly ever is followed by one that leaves none.
constexpr double hopeless = 0.9;
constexpr int first_rings = 3; // around a folded triangle; one more each round

// A member of the family with V regularised.
template <class Energy> struct Regularised {
  const Energy& energy;
  double eps; // in units of twice the reference area

  [[nodiscard]] double value(double V, double area) const { return energy.value(chi(V, 2 * area * eps).value, area); }
  [[nodiscard]] Jet jet(double V, double area) const {
    const Jet c = chi(V, 2 * area * eps), h = energy.jet(c.value, area);
    return {h.value, h.first * c.first, h.second * c.first * c.first + h.first * c.second};
  }

private:
  static Jet chi(double V, double e) {
    const double s = std::sqrt(V * V + e * e);
    const double value = V > 0 ? 0.5 * (V + s) : 0.5 * e * e / (s - V); // without cancellation
    return {value, value / s, 0.5 * e * e / (s * s * s)};
  }
};

template <class Energy>
double regularised_energy(const Regularised<Energy>& energy, std::span<const StarTerm> star, const Vec3d& p) {
  double sum = 0;
  for (const StarTerm& t : star) {
    const Vec3d u = t.a - p, v = t.b - p;
    const double D = 0.5 * (t.cot_b * squared_norm(u) + t.cot_a * squared_norm(v)) + t.fixed;
    sum += D * energy.value(dot(p, cross(u, v)), t.area);
  }
  return sum;
}

template <class Energy>
Vec3d regularised_step(const Regularised<Energy>& energy, std::span<const StarTerm> star, const Vec3d& p) {
  const TangentFrame frame(p);
  const Expansion e = expand(energy, star, p, frame);
  const Descent step = descent_step(e);
  double t = 1;
  for (int halving = 0; halving < 8; ++halving, t *= 0.5) {
    const Vec3d q = normalized(p + (t * step.x) * frame.x + (t * step.y) * frame.y);
    if (regularised_energy(energy, star, q) < e.energy) return q;
  }
  return p;
}

template <class Energy> class Untangling {
public:
  Untangling(const WholeLevel& level, const Energy& energy, std::span<const Vec3d> before, std::span<Vec3d> points,
             mesh::ThreadPool& pool)
      : level_(level), energy_(energy), before_(before), points_(points), pool_(pool) {}

  bool run() {
    std::vector<std::uint32_t> folded = all_folded();
    if (folded.empty()) return true;
    if (folded.size() > level_.triangles.size() / 100) return false;
    in_patch_.assign(points_.size(), 0);
    double eps = first_eps;
    for (int round = 0; round < rounds && !folded.empty(); ++round, eps *= eps_factor) {
      grow(folded, round == 0 ? first_rings : 1);
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Index v : patch_) move(v, eps);
      }
      const std::size_t before = folded.size();
      folded = folded_in_patch();
      if (static_cast<double>(folded.size()) > hopeless * static_cast<double>(before)) return false;
    }
    if (!folded.empty() || !every_star_winds_once()) return false;
    double gain = 0;
    for (int sweep = 0; sweep < last_sweeps; ++sweep) {
      for (const Index v : patch_) {
        gather_star(v, level_.stars, level_.references, points_, star_);
        points_[v] = newton_step(energy_, star_, points_[v], gain);
      }
    }
    return true;
  }

private:
  const WholeLevel& level_;
  const Energy& energy_;
  std::span<const Vec3d> before_;
  std::span<Vec3d> points_;
  mesh::ThreadPool& pool_;
  std::vector<Index> patch_; // the vertices that may move, in ascending order
  std::vector<std::uint8_t> in_patch_;
  std::vector<StarTerm> star_;

  [[nodiscard]] static double volume(const mesh::Triangle& t, std::span<const Vec3d> points) {
    const Vec3d& p = points[t[0]];
    return dot(p, cross(points[t[1]] - p, points[t[2]] - p));
  }
  [[nodiscard]] bool is_folded(std::uint32_t t) const { return !(volume(level_.triangles[t], points_) > 0); }

  [[nodiscard]] std::vector<std::uint32_t> all_folded() const {
    std::vector<std::vector<std::uint32_t>> found((level_.triangles.size() + grain - 1) / grain);
    pool_.for_blocks(level_.triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        if (is_folded(static_cast<std::uint32_t>(t))) found[begin / grain].push_back(static_cast<std::uint32_t>(t));
      }
    });
    std::vector<std::uint32_t> out;
    for (const auto& part : found) out.insert(out.end(), part.begin(), part.end());
    return out;
  }

  // Only triangles of the patch have changed.
  [[nodiscard]] std::vector<std::uint32_t> folded_in_patch() const {
    std::vector<std::uint32_t> out;
    for (const Index v : patch_) {
      for (const StarCorner& c : level_.stars[v]) {
        if (is_folded(c.triangle())) out.push_back(c.triangle());
      }
    }
    std::ranges::sort(out);
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  // Triangles without a fold can still lie around a vertex twice, and the map be a branched cover. Where every star
  // winds once it is locally, and so, on a sphere, altogether one to one. Vertices beside the patch have new stars too.
  [[nodiscard]] bool every_star_winds_once() const {
    const auto winds_once = [&](Index v) {
      const std::span<const StarCorner> star = level_.stars[v];
      const Vec3d& p = points_[v];
      double angle = 0; // in the tangent plane
      for (std::size_t k = 0; k < star.size(); ++k) {
        const Vec3d a = points_[star[k].next] - p, b = points_[previous_in(star, k)] - p;
        angle += std::atan2(dot(p, cross(a, b)), dot(a, b) - dot(a, p) * dot(b, p));
      }
      return angle < 3 * std::numbers::pi; // it is a multiple of 2 pi
    };
    std::vector<Index> changed = patch_;
    for (const Index v : patch_) {
      for (const StarCorner& c : level_.stars[v]) {
        if (in_patch_[c.next] == 0) changed.push_back(c.next);
      }
    }
    std::ranges::sort(changed);
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    return std::ranges::all_of(changed, winds_once);
  }

  void grow(std::span<const std::uint32_t> folded, int rings) {
    const auto add = [&](Index v) {
      if (in_patch_[v] == 0) patch_.push_back(v);
      in_patch_[v] = 1;
    };
    for (const std::uint32_t t : folded) std::ranges::for_each(level_.triangles[t], add);
    for (int ring = 0; ring < rings; ++ring) {
      for (std::size_t i = 0, n = patch_.size(); i < n; ++i) {
        for (const StarCorner& c : level_.stars[patch_[i]]) add(c.next);
      }
    }
    std::ranges::sort(patch_);
  }

  void move(Index v, double eps) {
    double area = 0, reference = 0;
    for (const StarCorner& c : level_.stars[v]) {
      area += volume(level_.triangles[c.triangle()], before_);
      reference += 2 * double{level_.references[c.triangle()].area};
    }
    gather_star(v, level_.stars, level_.references, points_, star_);
    points_[v] = regularised_step(Regularised<Energy>{energy_, eps * area / reference}, star_, points_[v]);
  }
};

} // namespace

bool untangle(const WholeLevel& level, std::span<const Vec3d> before, std::span<Vec3d> points, mesh::ThreadPool& pool) {
  return std::visit([&](const auto& energy) { return Untangling(level, energy, before, points, pool).run(); },
                    level.energy);
}

} // namespace orbis::sphere
