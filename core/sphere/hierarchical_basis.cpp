#include "core/sphere/hierarchical_basis.h"

#include <algorithm>
#include <cmath>

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 2048;
// A saddle is made convex: no eigenvalue below this part of the largest.
constexpr double smallest_eigenvalue = 0.1;

struct Symmetric {
  double xx, xy, yy;
};

Symmetric made_convex(const Expansion& e) {
  const double mean = 0.5 * (e.hxx + e.hyy), radius = std::hypot(0.5 * (e.hxx - e.hyy), e.hxy);
  const double shift = std::max(0.0, smallest_eigenvalue * std::abs(mean + radius) - (mean - radius));
  return {e.hxx + shift, e.hxy, e.hyy + shift};
}

// b^T m b for the symmetric 3 x 3 matrix m and the frame's axes.
Symmetric projected(const std::array<float, 6>& m, const TangentFrame& frame) {
  const auto times = [&](const Vec3d& v) {
    return Vec3d{double{m[0]} * v.x + double{m[1]} * v.y + double{m[2]} * v.z,
                 double{m[1]} * v.x + double{m[3]} * v.y + double{m[4]} * v.z,
                 double{m[2]} * v.x + double{m[4]} * v.y + double{m[5]} * v.z};
  };
  const Vec3d mx = times(frame.x), my = times(frame.y);
  return {dot(frame.x, mx), dot(frame.x, my), dot(frame.y, my)};
}

std::array<float, 3> inverted(const Symmetric& m) {
  const double det = std::max(m.xx * m.yy - m.xy * m.xy, 1e-9 * m.xx * m.yy);
  return {static_cast<float>(m.yy / det), static_cast<float>(-m.xy / det), static_cast<float>(m.xx / det)};
}

} // namespace

HierarchicalBasis::HierarchicalBasis(const Hierarchy& hierarchy, mesh::ThreadPool& pool)
    : hierarchy_(hierarchy), pool_(pool), stiffness_(hierarchy.removed.size() + 4) {}

void HierarchicalBasis::keep_stiffness(mesh::Index v, const Expansion& expansion, const Vec3d& p) {
  const Symmetric h = made_convex(expansion);
  const TangentFrame f(p);
  const auto entry = [&](double ax, double ay, double bx, double by) {
    return static_cast<float>(h.xx * ax * bx + h.xy * (ax * by + ay * bx) + h.yy * ay * by);
  };
  stiffness_[v] = {entry(f.x.x, f.y.x, f.x.x, f.y.x), entry(f.x.x, f.y.x, f.x.y, f.y.y),
                   entry(f.x.x, f.y.x, f.x.z, f.y.z), entry(f.x.y, f.y.y, f.x.y, f.y.y),
                   entry(f.x.y, f.y.y, f.x.z, f.y.z), entry(f.x.z, f.y.z, f.x.z, f.y.z)};
}

void HierarchicalBasis::write_stiffness(std::span<const mesh::Index> vertices, StateWriter& state) const {
  for (const mesh::Index v : vertices) state.value(stiffness_[v]);
}

void HierarchicalBasis::read_stiffness(std::span<const mesh::Index> vertices, StateReader& state) {
  for (const mesh::Index v : vertices) state.values(std::span<float>(stiffness_[v]));
}

// Mean value coordinates: neighbour k weighs (tan(a/2) + tan(b/2)) / distance, with the angles a, b on its two sides.
void HierarchicalBasis::weigh_ring(std::size_t removal, std::span<const Vec3d> points) {
  const std::span<const mesh::Index> ring = hierarchy_.ring(removal);
  const std::span<float> weights = std::span(weights_).subspan(hierarchy_.ring_first[removal], ring.size());
  const Vec3d& p = points[hierarchy_.removed[removal]];
  std::ranges::fill(weights, 0.0F);
  double sum = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::size_t next = (k + 1) % ring.size();
    const Vec3d a = points[ring[k]] - p, b = points[ring[next]] - p;
    const double la = norm(a), lb = norm(b);
    const double half_tangent = norm(cross(a, b)) / (la * lb + dot(a, b));
    weights[k] += static_cast<float>(half_tangent / la);
    weights[next] += static_cast<float>(half_tangent / lb);
    sum += half_tangent / la + half_tangent / lb;
  }
  const bool usable = std::isfinite(sum) && sum > 0 && sum < 1e30;
  for (float& w : weights) w = usable ? w / static_cast<float>(sum) : 1.0F / static_cast<float>(ring.size());
}

void HierarchicalBasis::prepare(std::span<const Vec3d> points) {
  const std::size_t n = points.size();
  frames_.resize(n);
  inverse_.resize(n);
  field_.resize(n);
  weights_.resize(hierarchy_.ring_vertices.size());
  pool_.for_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const TangentFrame frame(points[v]);
      frames_[v] = {Vec3f(frame.x), Vec3f(frame.y)};
      inverse_[v] = inverted(projected(stiffness_[v], frame));
    }
  });
  pool_.for_blocks(hierarchy_.removed.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) weigh_ring(i, points);
  });
}

void HierarchicalBasis::apply(std::span<const Tangent> in, std::span<Tangent> out) {
  const auto each = [&](auto body) {
    pool_.for_blocks(in.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) body(v);
    });
  };
  each([&](std::size_t v) {
    field_[v] = static_cast<float>(in[v].x) * frames_[v].x + static_cast<float>(in[v].y) * frames_[v].y;
  });
  for (std::size_t round = 0; round < hierarchy_.rounds(); ++round) hand_to_rings(round);
  each([&](std::size_t v) {
    const Frame& f = frames_[v];
    const std::array<float, 3>& m = inverse_[v];
    const float x = dot(field_[v], f.x), y = dot(field_[v], f.y);
    field_[v] = (m[0] * x + m[1] * y) * f.x + (m[1] * x + m[2] * y) * f.y;
  });
  for (std::size_t round = hierarchy_.rounds(); round-- > 0;) carry_by_rings(round);
  each([&](std::size_t v) { out[v] = {double{dot(field_[v], frames_[v].x)}, double{dot(field_[v], frames_[v].y)}}; });
}

// S^T, from fine to coarse: what a vertex bears is handed to its ring. Rings of one block share vertices.
void HierarchicalBasis::hand_to_rings(std::size_t round) {
  const std::size_t first = hierarchy_.round_block[round];
  pool_.for_blocks(hierarchy_.round_block[round + 1] - first, 1, [&](std::size_t block, std::size_t) {
    for (std::size_t i = hierarchy_.block_first[first + block]; i < hierarchy_.block_first[first + block + 1]; ++i) {
      const std::span<const mesh::Index> ring = hierarchy_.ring(i);
      const float* weights = weights_.data() + hierarchy_.ring_first[i];
      const Vec3f borne = field_[hierarchy_.removed[i]];
      for (std::size_t k = 0; k < ring.size(); ++k) field_[ring[k]] += weights[k] * borne;
    }
  });
}

// S, from coarse to fine: a vertex moves with its ring. Within a round nobody is in another's ring.
void HierarchicalBasis::carry_by_rings(std::size_t round) {
  const std::size_t first = hierarchy_.round_first[round];
  pool_.for_blocks(hierarchy_.round_first[round + 1] - first, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = first + begin; i < first + end; ++i) {
      const std::span<const mesh::Index> ring = hierarchy_.ring(i);
      const float* weights = weights_.data() + hierarchy_.ring_first[i];
      Vec3f carried{};
      for (std::size_t k = 0; k < ring.size(); ++k) carried += weights[k] * field_[ring[k]];
      field_[hierarchy_.removed[i]] += carried;
    }
  });
}

} // namespace orbis::sphere
