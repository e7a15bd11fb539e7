#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/lod/refine.h"

namespace orbis::lod {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>; // a position in space, and a scaled one in the atlas
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr double damping = 0.03;      // of the mean curvature: flat places hold u only through it
constexpr double least_gain = 1e-3;   // of the deviation
constexpr int most_halvings = 2;      // of Newton's step
constexpr double least_cosine = 0.2;  // of the angle by which a triangle may turn
constexpr std::size_t least_data = 4; // witnesses
constexpr std::size_t check_interval = 1024;

class Relocation {
public:
  explicit Relocation(Draft& draft)
      : draft_(draft), mesh_(draft.level().mesh), stars_(mesh_.vertices.size()), copies_(mesh_.points) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (const mesh::Index v : mesh_.triangles[t]) stars_[v].push_back(t);
    for (const texture::CutVertex& v : mesh_.vertices) ++copies_[v.point];
  }

  void run(const Progress& progress) {
    for (mesh::Index v = 0; v < mesh_.vertices.size(); ++v) {
      if (v % check_interval == 0) progress.check();
      if (is_free(v)) move(v);
    }
  }

private:
  // Inside a region: the point has one vertex, and the triangles around it close up.
  [[nodiscard]] bool is_free(mesh::Index v) {
    const texture::CutVertex& vertex = mesh_.vertices[v];
    if (stars_[v].empty() || copies_[vertex.point] != 1 || draft_.full().is_joint(vertex)) return false;
    ring_.clear();
    for (const std::uint32_t t : stars_[v])
      for (const mesh::Index w : mesh_.triangles[t])
        if (w != v) ring_.push_back(w);
    std::sort(ring_.begin(), ring_.end());
    for (std::size_t i = 0; i < ring_.size(); i += 2) {
      const bool is_pair = i + 1 < ring_.size() && ring_[i] == ring_[i + 1];
      if (!is_pair || (i + 2 < ring_.size() && ring_[i + 2] == ring_[i])) return false;
    }
    return true;
  }

  // r = sum_k w_k p_k - P at a witness. To move v in the atlas by d slides the level's map under the witness:
  // with the Jacobian J of the triangle's map, dr = w_v (dp - J d).
  struct NewtonStep {
    Vector5 step;
    double energy; // the sum of the deviations before it
  };
  [[nodiscard]] std::optional<NewtonStep> newton_step(mesh::Index v) {
    double energy = 0;
    Matrix5 h = Matrix5::Zero();
    Vector5 g = Vector5::Zero();
    const double scale = draft_.full().uv_scale();
    for (const std::uint32_t number : stars_[v]) {
      mesh::Triangle t = mesh_.triangles[number];
      while (t[0] != v) t = {t[1], t[2], t[0]};
      const Vec2f &a = mesh_.vertices[t[0]].uv, &b = mesh_.vertices[t[1]].uv, &c = mesh_.vertices[t[2]].uv;
      const double bx = scale * (double{b.x} - a.x), by = scale * (double{b.y} - a.y);
      const double cx = scale * (double{c.x} - a.x), cy = scale * (double{c.y} - a.y), area = bx * cy - by * cx;
      const Vec3d e1 = draft_.positions[t[1]] - draft_.positions[t[0]];
      const Vec3d e2 = draft_.positions[t[2]] - draft_.positions[t[0]];
      const Vec3d j0 = (e1 * cy - e2 * by) * (1 / area), j1 = (e2 * bx - e1 * cx) * (1 / area);
      const AtlasTriangle in_atlas = draft_.in_atlas(t);
      for (const std::uint32_t i : draft_.witnesses_of(number)) {
        const Witness& witness = draft_.witness(i);
        const std::array<double, 3> w = in_atlas.weights(witness.uv);
        const Vec3d p = draft_.positions[t[0]] * w[0] + draft_.positions[t[1]] * w[1] + draft_.positions[t[2]] * w[2];
        energy += witness.deviation(p);
        add(witness, p - witness.position, w[0], {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, -j0, -j1}, h, g);
      }
    }
    const double held = damping * h.trace() / 5;
    if (!(held > 0)) return std::nullopt;
    h.diagonal().array() += held;
    const Vector5 step = h.ldlt().solve(-g);
    if (!step.allFinite()) return std::nullopt;
    return NewtonStep{step, energy};
  }

  static void add(const Witness& witness, const Vec3d& r, double w, const std::array<Vec3d, 5>& derivatives, Matrix5& h,
                  Vector5& g) {
    const auto metric = [&](const Vec3d& v) {
      const auto& [weight, own_slip] = witness.weighing;
      return (witness.normal * ((1 - own_slip) * dot(witness.normal, v)) + v * own_slip) * weight;
    };
    const Vec3d pull = metric(r);
    for (int i = 0; i < 5; ++i) {
      const Vec3d d = derivatives[static_cast<std::size_t>(i)];
      const Vec3d m = metric(d);
      g[i] += w * dot(d, pull);
      for (int j = 0; j <= i; ++j) {
        const double value = w * w * dot(m, derivatives[static_cast<std::size_t>(j)]);
        h(i, j) += value;
        if (i != j) h(j, i) += value;
      }
    }
  }

  void move(mesh::Index v) {
    draft_.collect(stars_[v], held_);
    if (held_.size() < least_data) return;
    const std::optional<NewtonStep> newton = newton_step(v);
    if (!newton) return;
    triangles_.clear();
    normals_.clear();
    for (const std::uint32_t t : stars_[v]) {
      triangles_.push_back(mesh_.triangles[t]);
      normals_.push_back(draft_.area_normal(triangles_.back()));
    }
    const texture::CutVertex before = mesh_.vertices[v];
    const Vec3d position = draft_.positions[v];
    const double most = (1 - least_gain) * newton->energy;
    const int sign = draft_.atlas_orientation(triangles_[0]);
    for (int halvings = 0; halvings <= most_halvings; ++halvings) {
      const double length = std::ldexp(1, -halvings);
      if (put(v, before, position, newton->step * length) && is_sound(sign) &&
          draft_.energy(held_, triangles_) < most) {
        draft_.level().near[v] = near_;
        draft_.hand_over(held_, stars_[v]);
        return;
      }
    }
    mesh_.vertices[v] = before;
    draft_.positions[v] = position;
  }

  // False where the new place in the atlas is outside of the chart.
  bool put(mesh::Index v, const texture::CutVertex& before, const Vec3d& position, const Vector5& step) {
    const FullSurface& full = draft_.full();
    texture::CutVertex& vertex = mesh_.vertices[v];
    vertex.uv = {static_cast<float>(before.uv.x + step[3] / full.uv_scale()),
                 static_cast<float>(before.uv.y + step[4] / full.uv_scale())};
    const std::optional<Place> place = full.chart_map().locate({vertex.uv.x, vertex.uv.y}, draft_.level().near[v]);
    if (!place) return false;
    vertex.triangle = full.cut().parent[place->triangle];
    vertex.barycentric = full.weights_on_parent(*place);
    vertex.sphere = full.sphere_point(*place);
    near_ = place->triangle;
    draft_.positions[v] = position + Vec3d{step[0], step[1], step[2]};
    return true;
  }

  [[nodiscard]] bool is_sound(int sign) const {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (!draft_.is_sound(triangles_[i], sign)) return false;
      const Vec3d n = draft_.area_normal(triangles_[i]);
      if (!(dot(n, normals_[i]) > least_cosine * norm(n) * norm(normals_[i]))) return false;
    }
    return true;
  }

  Draft& draft_;
  texture::CutMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> stars_; // by vertex: the triangles around it
  std::vector<std::uint32_t> copies_;             // by point: its vertices
  // Of the vertex in work:
  std::vector<Held> held_; // witnesses around it
  std::vector<mesh::Index> ring_;
  std::vector<mesh::Triangle> triangles_;
  std::vector<Vec3d> normals_;
  std::uint32_t near_ = 0;
};

} // namespace

void relocate(Draft& draft, const Progress& progress) { Relocation(draft).run(progress); }

} // namespace orbis::lod
