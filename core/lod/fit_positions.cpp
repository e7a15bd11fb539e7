#include "core/lod/fit_positions.h"

#include <algorithm>
#include <cmath>

#include "core/lod/extract.h"

namespace orbis::lod {
namespace {

constexpr int steps = 12;
// Of a point's own weight, and of what it would be if samples lay all over its triangles: holds what no sample sees, or
// only from afar, where it is.
constexpr double hold = 1e-3, hold_by_area = 5e-3;
constexpr double farthest = 0.5;     // that a point may go, in units of its longest edge
constexpr double least_cosine = 0.2; // of the angle by which a triangle may turn

using Vectors = std::vector<Vec3d>; // one per point of the level

double dot(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += orbis::dot(a[i], b[i]);
  return sum;
}

void add(Symmetric3& to, const Symmetric3& m, double scale) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += scale * m[i];
}

// The normal equations, triangle by triangle.
class Fit {
public:
  Fit(const FullSurface& full, const Level& level) : full_(full), level_(level), blocks_(level.mesh.triangles.size()) {
    const std::size_t points = level.mesh.points;
    positions_.resize(points);
    right_.resize(points);
    joint_.assign(points, false);
    for (std::size_t v = 0; v < level.positions.size(); ++v) {
      const texture::CutVertex& vertex = level.mesh.vertices[v];
      positions_[vertex.point] = full.in_scale(level.positions[v]);
      joint_[vertex.point] = joint_[vertex.point] || full.is_joint(vertex);
    }
    sample();
  }

  // Positions that make the sum smaller; by point.
  Vectors solve() {
    std::vector<Symmetric3> diagonal(positions_.size());
    for (std::size_t t = 0; t < blocks_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) add(diagonal[point(t, k)], blocks_[t][k], 1);
    std::vector<double> expected = weight_by_area();
    holds_.reserve(diagonal.size());
    std::vector<Symmetric3> inverses;
    inverses.reserve(diagonal.size());
    for (std::size_t p = 0; p < diagonal.size(); ++p) {
      Symmetric3& d = diagonal[p];
      const double held = hold * (d[0] + d[3] + d[5]) / 3 + hold_by_area * expected[p];
      holds_.push_back(held);
      for (const std::size_t i : {0, 3, 5}) d[i] += held;
      inverses.push_back(inverse(d).value_or(Symmetric3{}));
    }

    // Conjugate gradients from where the points are, with the inverted 3x3 blocks as preconditioner.
    Vectors x = positions_, r = right_, z(x.size(), Vec3d{}), p;
    const Vectors ax = product_with(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      r[i] += positions_[i] * holds_[i] - ax[i];
      if (!joint_[i]) z[i] = product(inverses[i], r[i]); // joints are no unknowns: their steps are 0
    }
    p = z;
    double rz = dot(r, z);
    for (int step = 0; step < steps && rz > 0; ++step) {
      const Vectors ap = product_with(p);
      const double alpha = rz / dot(p, ap);
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] += p[i] * alpha;
        r[i] -= ap[i] * alpha;
        if (!joint_[i]) z[i] = product(inverses[i], r[i]);
      }
      const double next = dot(r, z), beta = next / rz;
      rz = next;
      for (std::size_t i = 0; i < x.size(); ++i) p[i] = z[i] + p[i] * beta;
    }
    return x;
  }

  // Points that went far go back, then those of triangles that turn over, until none does.
  void put_back_wrong(Vectors& x) const {
    std::vector<double> longest(x.size(), 0); // squared edge
    for (std::size_t t = 0; t < blocks_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = point(t, k), j = point(t, (k + 1) % 3);
        const double edge = squared_norm(positions_[i] - positions_[j]);
        longest[i] = std::max(longest[i], edge);
        longest[j] = std::max(longest[j], edge);
      }
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!(squared_norm(x[i] - positions_[i]) <= farthest * farthest * longest[i])) x[i] = positions_[i];
    for (bool any = true; any;) {
      any = false;
      for (std::size_t t = 0; t < blocks_.size(); ++t) {
        const Vec3d before = normal(positions_, t), after = normal(x, t);
        if (orbis::dot(before, after) >= least_cosine * std::sqrt(squared_norm(before) * squared_norm(after))) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          any = any || !(x[point(t, k)] == positions_[point(t, k)]);
          x[point(t, k)] = positions_[point(t, k)];
        }
      }
    }
  }

private:
  // By point: the samples' weight times the square of its share in them, if they lay evenly on its triangles.
  [[nodiscard]] std::vector<double> weight_by_area() const {
    std::vector<double> out(positions_.size(), 0);
    double area = 0;
    for (std::size_t t = 0; t < blocks_.size(); ++t) {
      const double own = norm(normal(positions_, t));
      area += own;
      for (std::size_t k = 0; k < 3; ++k) out[point(t, k)] += own / 6;
    }
    for (double& each : out) each *= area > 0 ? weight_ / area : 0;
    return out;
  }

  [[nodiscard]] std::uint32_t point(std::size_t t, std::size_t k) const {
    return level_.mesh.vertices[level_.mesh.triangles[t][k]].point;
  }
  [[nodiscard]] Vec3d normal(const Vectors& x, std::size_t t) const {
    const Vec3d a = x[point(t, 0)];
    return cross(x[point(t, 1)] - a, x[point(t, 2)] - a);
  }

  // Corners and centroid of each triangle of the full surface: with weights 1/12 and 3/4 of its area that integrates
  // quadratics exactly.
  void sample() {
    const texture::CutMesh& cut = full_.cut();
    const ChartMap map(level_.mesh, level_.regions);
    std::vector<std::uint32_t> near = first_of_regions(full_, level_);
    for (std::uint32_t t = 0; t < cut.triangles.size(); ++t) {
      std::uint32_t& from = near[full_.regions()[t]];
      if (from == none) continue; // the level has lost this component
      const auto& [weight, own_slip] = full_.weighing(t);
      if (!(weight > 0)) continue;
      const Vec3d& n = full_.normal(t);
      const double rest = 1 - own_slip;
      const Symmetric3 m{own_slip + rest * n.x * n.x, rest * n.x * n.y, rest * n.x * n.z,
                         own_slip + rest * n.y * n.y, rest * n.y * n.z, own_slip + rest * n.z * n.z};
      constexpr double third = 1.0 / 3;
      for (const auto& w : {std::array{third, third, third}, std::array{1.0, 0.0, 0.0}, std::array{0.0, 1.0, 0.0},
                            std::array{0.0, 0.0, 1.0}}) {
        Uv uv{};
        for (std::size_t k = 0; k < 3; ++k) {
          uv[0] += w[k] * cut.vertices[cut.triangles[t][k]].uv.x;
          uv[1] += w[k] * cut.vertices[cut.triangles[t][k]].uv.y;
        }
        const std::optional<Place> place = map.locate(uv, from);
        if (!place) continue; // a border's rounding
        from = place->triangle;
        add_sample(*place, m, full_.position({t, w}), weight * (w[0] == third ? 0.75 : 1.0 / 12));
      }
    }
  }

  void add_sample(const Place& place, const Symmetric3& m, const Vec3d& at, double weight) {
    const auto& w = place.weights;
    auto& block = blocks_[place.triangle];
    weight_ += weight;
    const Vec3d right = product(m, at) * weight;
    for (std::size_t k = 0; k < 3; ++k) {
      add(block[k], m, weight * w[k] * w[k]);
      add(block[3 + k], m, weight * w[k] * w[(k + 1) % 3]);
      right_[point(place.triangle, k)] += right * w[k];
    }
  }

  [[nodiscard]] Vectors product_with(const Vectors& x) const {
    Vectors out(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = x[i] * holds_[i];
    for (std::size_t t = 0; t < blocks_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = point(t, k), j = point(t, (k + 1) % 3);
        out[i] += product(blocks_[t][k], x[i]) + product(blocks_[t][3 + k], x[j]);
        out[j] += product(blocks_[t][3 + k], x[i]);
      }
    }
    return out;
  }

  const FullSurface& full_;
  const Level& level_;
  std::vector<std::array<Symmetric3, 6>> blocks_; // of corners 0 0, 1 1, 2 2, 0 1, 1 2, 2 0 of each triangle
  Vectors positions_, right_;
  std::vector<double> holds_;
  double weight_ = 0;       // of all samples
  std::vector<bool> joint_; // by point
};

} // namespace

void fit_positions(const FullSurface& full, Level& level) {
  Fit fit(full, level);
  Vectors x = fit.solve();
  fit.put_back_wrong(x);
  for (std::size_t v = 0; v < level.positions.size(); ++v)
    level.positions[v] = full.in_model(x[level.mesh.vertices[v].point]);
}

} // namespace orbis::lod
