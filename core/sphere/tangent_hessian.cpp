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

// Adds the block of corners i and j, each in its vertex' frame.
void add_block(const TrianglePart& part, std::size_t i, const Turn& ti, std::size_t j, const Turn& tj,
               std::array<float, 4>& block) {
  std::array<double, 4> sum{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double ix = ti.xx * part.wx[i][k] + ti.xy * part.wy[i][k], iy = ti.yx * part.wx[i][k] + ti.yy * part.wy[i][k];
    const double jx = tj.xx * part.wx[j][k] + tj.xy * part.wy[j][k], jy = tj.yx * part.wx[j][k] + tj.yy * part.wy[j][k];
    sum[0] += ix * jx;
    sum[1] += ix * jy;
    sum[2] += iy * jx;
    sum[3] += iy * jy;
  }
  for (std::size_t e = 0; e < 4; ++e) block[e] += static_cast<float>(sum[e]);
}

} // namespace

template <class Energy>
void TangentHessian::build_row(const Energy& energy, mesh::Index v, std::span<const Reference> references,
                               std::span<const Vec3d> points) {
  const std::span<const StarCorner> star = (*stars_)[v];
  const std::span<Block> row = std::span(neighbour_).subspan(stars_->first(v), star.size());
  const TangentFrame frame(points[v]);
  own_[v] = {};
  std::ranges::fill(row, Block{});
  for (std::size_t k = 0; k < star.size(); ++k) {
    const StarCorner& c = star[k];
    const Reference& reference = references[c.triangle()];
    const std::size_t at = c.place(), next = k + 1 == star.size() ? 0 : k + 1;
    const mesh::Index previous = star[next].next;
    const TrianglePart part =
        part_of(energy, {points[v], points[c.next], points[previous]},
                {double{reference.cot[at]}, double{reference.cot[(at + 1) % 3]}, double{reference.cot[(at + 2) % 3]}},
                double{reference.area});
    const Turn here = turn_to(part.plane, frame);
    add_block(part, 0, here, 0, here, own_[v]);
    add_block(part, 0, here, 1, turn_to(part.plane, TangentFrame(points[c.next])), row[k]);
    add_block(part, 0, here, 2, turn_to(part.plane, TangentFrame(points[previous])), row[next]);
  }
}

void TangentHessian::build(const TriangleEnergy& energy, const StarTable& stars, std::span<const Reference> references,
                           std::span<const Vec3d> points, mesh::ThreadPool& pool) {
  stars_ = &stars;
  own_.resize(points.size());
  neighbour_.resize(stars.corners());
  std::visit(
      [&](const auto& e) {
        pool.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t v = begin; v < end; ++v) build_row(e, static_cast<mesh::Index>(v), references, points);
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
