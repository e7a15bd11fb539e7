#include "core/sphere/tangent_hessian.h"

#include <algorithm>

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 2048;

void add(const TriangleHessian::Block& part, TangentHessian::Block& sum) {
  for (std::size_t e = 0; e < 4; ++e) sum[e] += static_cast<float>(part[e]);
}

} // namespace

void TangentHessian::add_row(const TriangleHessian& part, std::size_t corner, mesh::Index v, std::size_t k) {
  Block* const row = &neighbour_[stars_->first(v)];
  add(part.block(corner, corner), own_[v]);
  add(part.block(corner, (corner + 1) % 3), row[k]);
  add(part.block(corner, (corner + 2) % 3), row[k + 1 == stars_->degree(v) ? 0 : k + 1]);
}

// A triangle is taken once, from its corner of the lowest number here, for all its corners here. Vertices of near
// numbers are near each other, so that few triangles have corners in several blocks.
template <class Energy>
void TangentHessian::build_rows(const Energy& energy, mesh::Index begin, mesh::Index end,
                                std::span<const Reference> references, std::span<const Vec3d> points,
                                double exact_share) {
  const auto add_if_here = [&](const TriangleHessian& part, std::size_t corner, mesh::Index v, std::uint32_t triangle) {
    if (v < begin || v >= end) return;
    const auto star = (*stars_)[v];
    const auto at = std::ranges::find(star, triangle, &StarCorner::triangle);
    add_row(part, corner, v, static_cast<std::size_t>(at - star.begin()));
  };
  const std::size_t first = stars_->first(begin), last = stars_->first(end - 1) + stars_->degree(end - 1);
  std::ranges::fill(std::span(own_).subspan(begin, end - begin), Block{});
  std::ranges::fill(std::span(neighbour_).subspan(first, last - first), Block{});
  for (mesh::Index v = begin; v < end; ++v) {
    const std::span<const StarCorner> star = (*stars_)[v];
    for (std::size_t k = 0; k < star.size(); ++k) {
      const mesh::Index a = star[k].next, b = previous_in(star, k);
      if ((a >= begin && a < v) || (b >= begin && b < v)) continue;
      const Reference& reference = references[star[k].triangle()];
      const std::size_t at = star[k].place();
      const SphereTriangle triangle{
          {points[v], points[a], points[b]},
          {double{reference.cot[at]}, double{reference.cot[(at + 1) % 3]}, double{reference.cot[(at + 2) % 3]}},
          double{reference.area}};
      const TriangleHessian part(energy, triangle, exact_share);
      add_row(part, 0, v, k);
      add_if_here(part, 1, a, star[k].triangle());
      add_if_here(part, 2, b, star[k].triangle());
    }
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
          build_rows(e, static_cast<mesh::Index>(begin), static_cast<mesh::Index>(end), references, points,
                     exact_share);
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
