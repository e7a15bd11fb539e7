#include "core/sphere/tangent_hessian.h"

#include <algorithm>
#include <cmath>

#include "core/sphere/energy_modes.h"

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 512;

// Rows of the gradient operator: F = sum over the corners of (position in the plane) x (gradient of its hat function).
struct HatGradients {
  std::array<double, 3> x, y;
};

// The reference triangle with corner 0 at the origin and corner 1 on the x axis: squared length of the edge opposite
// corner k is 2 A (cot_i + cot_j).
HatGradients hat_gradients(const std::array<double, 3>& cot, double area) {
  const double length = std::sqrt(2 * area * (cot[0] + cot[1])); // from corner 0 to 1, opposite 2
  const double y2 = 2 * area / length, x2 = y2 * cot[0];
  const double inverse = 1 / (2 * area);
  return {{-y2 * inverse, y2 * inverse, 0}, {(x2 - length) * inverse, -x2 * inverse, length * inverse}};
}

// Singular values s1 >= s2 of [a b; c d] = U diag(s1, s2) V^T, and the cosines and sines of the rotations U and V.
struct Svd {
  double s1, s2, cu, su, cv, sv;
};

Svd decompose(double a, double b, double c, double d) {
  // Blinn, Consider the lowly 2 x 2 matrix (1996): a rotation part of size q and a reflection part of size r.
  const double e = 0.5 * (a + d), f = 0.5 * (a - d), g = 0.5 * (c + b), h = 0.5 * (c - b);
  const double q = std::hypot(e, h), r = std::hypot(f, g);
  const double a1 = std::atan2(g, f), a2 = std::atan2(h, e);
  const double u = 0.5 * (a2 + a1), v = 0.5 * (a1 - a2); // the angles of U and V
  return {q + r, q - r, std::cos(u), std::sin(u), std::cos(v), std::sin(v)};
}

// The plane of a triangle on the sphere.
struct Plane {
  Vec3d x, y;
};

Plane plane_of(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d x = normalized(a - p);
  const Vec3d n = normalized(cross(a - p, b - p));
  return {x, cross(n, x)};
}

// One triangle's part: modes m_k (as 2 x 2 matrices [xx xy; yx yy]) with eigenvalues, contracted with the hat
// gradients: for corner i and mode k the vector w_ik in the triangle's plane; the block (i, j) is sum_k lambda_k w_ik
// w_jk^T.
struct TrianglePart {
  std::array<std::array<double, 4>, 3> wx, wy; // [corner][mode], already times sqrt(lambda A)
  Plane plane;
};

template <class Energy>
TrianglePart part_of(const Energy& energy, const std::array<Vec3d, 3>& q, const std::array<double, 3>& cot,
                     double area) {
  TrianglePart out;
  out.plane = plane_of(q[0], q[1], q[2]);
  const HatGradients hat = hat_gradients(cot, area);
  // Image positions in the plane, corner 0 at the origin.
  const Vec3d e1 = q[1] - q[0], e2 = q[2] - q[0];
  const double x1 = dot(e1, out.plane.x), x2 = dot(e2, out.plane.x), y2 = dot(e2, out.plane.y);
  const double fxx = x1 * hat.x[1] + x2 * hat.x[2], fxy = x1 * hat.y[1] + x2 * hat.y[2];
  const double fyx = y2 * hat.x[2], fyy = y2 * hat.y[2];
  const Svd s = decompose(fxx, fxy, fyx, fyy);
  const double s1 = s.s1, s2 = std::max(s.s2, 1e-9 * s.s1);
  const Modes modes = modes_of(energy, s1, s2);
  const double r = std::sqrt(0.5);
  // Columns u1 = (cu, su), u2 = (-su, cu) of U; v1, v2 of V alike. Mode matrices: c u1 v1^T + s u2 v2^T,
  // c u2 v2^T - s u1 v1^T, (u1 v2^T + u2 v1^T) r, (u2 v1^T - u1 v2^T) r.
  for (std::size_t i = 0; i < 3; ++i) {
    const double g1 = hat.x[i] * s.cv + hat.y[i] * s.sv, g2 = -hat.x[i] * s.sv + hat.y[i] * s.cv; // hat in V's frame
    const std::array<double, 4> a{modes.c * g1, -modes.s * g1, r * g2, -r * g2},
        b{modes.s * g2, modes.c * g2, r * g1, r * g1}; // along u1 and u2
    for (std::size_t k = 0; k < 4; ++k) {
      const double scale = std::sqrt(modes.lambda[k] * area);
      out.wx[i][k] = scale * (a[k] * s.cu - b[k] * s.su);
      out.wy[i][k] = scale * (a[k] * s.su + b[k] * s.cu);
    }
  }
  return out;
}

// From the triangle's plane to the tangent frame of a vertex.
struct Turn {
  double xx, xy, yx, yy; // rows: frame; columns: plane
};

Turn turn_to(const Plane& plane, const TangentFrame& frame) {
  return {dot(frame.x, plane.x), dot(frame.x, plane.y), dot(frame.y, plane.x), dot(frame.y, plane.y)};
}

using Block = TangentHessian::Block;

void add(const std::array<double, 4>& sum, double share, Block& block) {
  for (std::size_t e = 0; e < 4; ++e) block[e] += static_cast<float>(share * sum[e]);
}

// The block of corners i and j, each in its vertex' frame.
std::array<double, 4> convex_block(const TrianglePart& part, std::size_t i, const Turn& ti, std::size_t j,
                                   const Turn& tj) {
  std::array<double, 4> sum{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double ix = ti.xx * part.wx[i][k] + ti.xy * part.wy[i][k], iy = ti.yx * part.wx[i][k] + ti.yy * part.wy[i][k];
    const double jx = tj.xx * part.wx[j][k] + tj.xy * part.wy[j][k], jy = tj.yx * part.wx[j][k] + tj.yy * part.wy[j][k];
    sum[0] += ix * jx;
    sum[1] += ix * jy;
    sum[2] += iy * jx;
    sum[3] += iy * jy;
  }
  return sum;
}

// A triangle (p_0, p_1, p_2) as the exact Hessian's row of corner 0 sees it.
template <class Energy> class ExactRow {
public:
  ExactRow(const Energy& energy, const std::array<Vec3d, 3>& p, const std::array<const TangentFrame*, 3>& frame,
           const std::array<double, 3>& cot, double area)
      : p_(p), frame_(frame), cot_(cot) {
    V_ = dot(p[0], cross(p[1] - p[0], p[2] - p[0]));
    for (std::size_t k = 0; k < 3; ++k) D_ += 0.5 * cot[k] * squared_norm(p[(k + 1) % 3] - p[(k + 2) % 3]);
    h_ = energy.jet(V_, area);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      // From differences, but for parts along p_i.
      const Vec3d dD = cot[k] * (p[i] - p[j]) + cot[j] * (p[i] - p[k]), dV = cross(p[j], p[k]);
      D1_[i] = {dot(dD, frame[i]->x), dot(dD, frame[i]->y)};
      V1_[i] = {dot(dV, frame[i]->x), dot(dV, frame[i]->y)};
    }
  }

  // The block of corners 0 and j.
  [[nodiscard]] std::array<double, 4> block(std::size_t j) const {
    const Tangent &d = D1_[0], &v = V1_[0], &dj = D1_[j], &vj = V1_[j];
    const double first = h_.first, second = D_ * h_.second;
    std::array<double, 4> out{first * (d.x * vj.x + v.x * dj.x) + second * v.x * vj.x,
                              first * (d.x * vj.y + v.x * dj.y) + second * v.x * vj.y,
                              first * (d.y * vj.x + v.y * dj.x) + second * v.y * vj.x,
                              first * (d.y * vj.y + v.y * dj.y) + second * v.y * vj.y};
    if (j == 0) {
      const double diagonal = h_.value * (cot_[2] * dot(p_[0], p_[1]) + cot_[1] * dot(p_[0], p_[2])) - D_ * first * V_;
      out[0] += diagonal;
      out[3] += diagonal;
      return out;
    }
    const std::size_t k = 3 - j;                                     // neither 0 nor j
    const Vec3d other = (j == 1 ? D_ * first : -D_ * first) * p_[k]; // det(u_0, u_j, p_k) for j = 1, its opposite for 2
    const auto mixed = [&](const Vec3d& a, const Vec3d& b) {
      return -h_.value * cot_[k] * dot(a, b) + dot(cross(a, b), other);
    };
    const TangentFrame &f = *frame_[0], &g = *frame_[j];
    out[0] += mixed(f.x, g.x);
    out[1] += mixed(f.x, g.y);
    out[2] += mixed(f.y, g.x);
    out[3] += mixed(f.y, g.y);
    return out;
  }

private:
  const std::array<Vec3d, 3>& p_;
  const std::array<const TangentFrame*, 3>& frame_;
  const std::array<double, 3>& cot_;
  double V_ = 0, D_ = 0;
  Jet h_{};
  std::array<Tangent, 3> D1_, V1_;
};

} // namespace

template <class Energy>
void TangentHessian::build_row(const Energy& energy, mesh::Index v, std::span<const Reference> references,
                               std::span<const Vec3d> points, double exact_share) {
  const std::span<const StarCorner> star = (*stars_)[v];
  const std::span<Block> row = std::span(neighbour_).subspan(stars_->first(v), star.size());
  const TangentFrame frame(points[v]);
  own_[v] = {};
  std::ranges::fill(row, Block{});
  for (std::size_t k = 0; k < star.size(); ++k) {
    const StarCorner& c = star[k];
    const Reference& reference = references[c.triangle()];
    const std::size_t at = c.place(), next = k + 1 == star.size() ? 0 : k + 1;
    const std::array<Vec3d, 3> p{points[v], points[c.next], points[star[next].next]};
    const TangentFrame frame_1(p[1]), frame_2(p[2]);
    const std::array<double, 3> cot{double{reference.cot[at]}, double{reference.cot[(at + 1) % 3]},
                                    double{reference.cot[(at + 2) % 3]}};
    const double area{reference.area};
    const std::array<Block*, 3> blocks{&own_[v], &row[k], &row[next]};
    const TrianglePart part = part_of(energy, p, cot, area);
    const std::array<const TangentFrame*, 3> frames{&frame, &frame_1, &frame_2};
    const Turn here = turn_to(part.plane, frame);
    for (std::size_t j = 0; j < 3; ++j) {
      const Turn there = j == 0 ? here : turn_to(part.plane, *frames[j]);
      add(convex_block(part, 0, here, j, there), 1 - exact_share, *blocks[j]);
    }
    if (exact_share == 0) continue;
    const ExactRow exact(energy, p, frames, cot, area);
    for (std::size_t j = 0; j < 3; ++j) add(exact.block(j), exact_share, *blocks[j]);
  }
}

void TangentHessian::build(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                           std::span<const Vec3d> points, double exact_share, mesh::ThreadPool& pool) {
  stars_ = &stars;
  own_.resize(points.size());
  neighbour_.resize(stars.corners());
  std::visit(
      [&](const auto& e) {
        pool.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t v = begin; v < end; ++v) {
            build_row(e, static_cast<mesh::Index>(v), references, points, exact_share);
          }
        });
      },
      energy);
}

void TangentHessian::apply(std::span<const Tangent> in, std::span<Tangent> out, mesh::ThreadPool& pool) const {
  const auto times = [](const Block& b, const Tangent& t, Tangent& sum) {
    sum.x += double{b[0]} * t.x + double{b[1]} * t.y;
    sum.y += double{b[2]} * t.x + double{b[3]} * t.y;
  };
  pool.for_blocks(in.size(), 4 * grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<const StarCorner> star = (*stars_)[static_cast<mesh::Index>(v)];
      const Block* block = neighbour_.data() + stars_->first(static_cast<mesh::Index>(v));
      Tangent sum;
      times(own_[v], in[v], sum);
      for (const StarCorner& c : star) times(*block++, in[c.next], sum);
      out[v] = sum;
    }
  });
}

void tangent_gradient(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                      std::span<const Vec3d> points, std::span<Tangent> out, mesh::ThreadPool& pool) {
  std::visit(
      [&](const auto& member) {
        pool.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
          std::vector<StarTerm> star;
          for (std::size_t v = begin; v < end; ++v) {
            gather_star(static_cast<mesh::Index>(v), stars, references, points, star);
            const Expansion e = expand(member, star, points[v], TangentFrame(points[v]));
            out[v] = {e.gx, e.gy};
          }
        });
      },
      energy);
}

} // namespace orbis::sphere
