#include "core/sphere/moebius_centring.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/sphere/shape_preserving_placement.h"
#include "core/sphere/sphere_math.h"

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 4096;
constexpr int most_steps = 30;
constexpr int most_halvings = 8;
constexpr double longest_step = 0.5; // in the unit ball
constexpr double centred = 1e-4;

// Sums over the triangles, each weighted by its reference area a: of l = log(area ratio) and of p, its middle.
struct Moments {
  double a = 0, al = 0, all = 0;
  Eigen::Vector3d ap = Eigen::Vector3d::Zero(), alp = Eigen::Vector3d::Zero();
  Eigen::Matrix3d app = Eigen::Matrix3d::Zero();
  bool folded = false;

  Moments& operator+=(const Moments& b) {
    a += b.a;
    al += b.al;
    all += b.all;
    ap += b.ap;
    alp += b.alp;
    app += b.app;
    folded = folded || b.folded;
    return *this;
  }
  [[nodiscard]] double variance() const {
    return folded ? std::numeric_limits<double>::infinity() : all / a - al * al / (a * a);
  }
};

class Centring {
public:
  Centring(std::span<const mesh::Triangle> triangles, std::span<const Reference> references, mesh::ThreadPool& pool)
      : triangles_(triangles), references_(references), pool_(pool) {}

  [[nodiscard]] Moments moments(std::span<const Vec3d> points) {
    std::vector<Moments> parts((triangles_.size() + grain - 1) / grain);
    pool_.for_blocks(triangles_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add(i, points, parts[begin / grain]);
    });
    Moments out;
    for (const Moments& part : parts) out += part; // in the order of the blocks
    return out;
  }

private:
  void add(std::size_t i, std::span<const Vec3d> points, Moments& out) const {
    const mesh::Triangle& t = triangles_[i];
    const Vec3d &p = points[t[0]], &q = points[t[1]], &r = points[t[2]];
    const double V = triple_product(p, q, r);
    if (!(V > 0)) {
      out.folded = true;
      return;
    }
    const double a = double{references_[i].area}, l = std::log(V / (2 * a));
    const Vec3d m = normalized(p + q + r);
    const Eigen::Vector3d middle(m.x, m.y, m.z);
    out.a += a;
    out.al += a * l;
    out.all += a * l * l;
    out.ap += a * middle;
    out.alp += a * l * middle;
    out.app += a * middle * middle.transpose();
  }

  std::span<const mesh::Triangle> triangles_;
  std::span<const Reference> references_;
  mesh::ThreadPool& pool_;
};

// Gauss-Newton: the Moebius map of a small vector s changes l at p by 4 s.p to first order, so the variance is least
// where s solves the normal equations 4 cov(p, p) s = -cov(l, p).
Vec3d step_of(const Moments& m) {
  const Eigen::Vector3d mean = m.ap / m.a;
  const Eigen::Matrix3d spread = m.app / m.a - mean * mean.transpose();
  const Eigen::Vector3d covariance = m.alp / m.a - m.al / m.a * mean;
  const Eigen::Vector3d s = -0.25 * spread.ldlt().solve(covariance);
  const double length = s.norm();
  if (!std::isfinite(length)) return {};
  const double scale = length > longest_step ? longest_step / length : 1;
  return {scale * s.x(), scale * s.y(), scale * s.z()};
}

} // namespace

double centre_by_moebius(std::span<const mesh::Triangle> triangles, std::span<const Reference> references,
                         std::span<Vec3d> points, mesh::ThreadPool& pool) {
  Centring centring(triangles, references, pool);
  std::vector<Vec3d> trial(points.size());
  Moments now = centring.moments(points);
  for (int step = 0; step < most_steps; ++step) {
    Vec3d s = step_of(now);
    if (norm(s) < centred) break;
    bool better = false;
    for (int halving = 0; halving < most_halvings && !better; ++halving, s *= 0.5) {
      pool.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) trial[v] = moebius(points[v], s);
      });
      const Moments then = centring.moments(trial);
      better = then.variance() < now.variance();
      if (better) now = then;
    }
    if (!better) break;
    std::ranges::copy(trial, points.begin());
  }
  return now.variance();
}

} // namespace orbis::sphere
