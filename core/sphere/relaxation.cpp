#include "core/sphere/relaxation.h"

#include <algorithm>
#include <atomic>
#include <bit>

namespace orbis::sphere {
namespace {

using mesh::Index;

constexpr std::size_t border_grain = 256;
constexpr std::size_t triangle_grain = 4096;
constexpr std::uint8_t uncolored = 255;

// Moves vertices of one level; a thread's own.
template <class Energy> class Mover {
public:
  Mover(const Level& level, const Energy& energy, double worthwhile, std::span<Vec3d> points, Active& active)
      : level_(level), energy_(energy), worthwhile_(worthwhile), points_(points), active_(active) {}

  // Returns whether v was active.
  bool visit(Index v) {
    if (active_[v] == 0) return false;
    active_[v] = 0;
    gather_star(v, level_.stars, level_.references, points_, star_);
    double gain = 0;
    points_[v] = newton_step(energy_, star_, points_[v], gain);
    if (gain <= worthwhile_) return true;
    wake(v);
    for (const StarCorner& c : level_.stars[v]) wake(c.next);
    return true;
  }

private:
  const Level& level_;
  const Energy& energy_;
  double worthwhile_;
  std::span<Vec3d> points_;
  Active& active_;
  std::vector<StarTerm> star_;

  // Two vertices of one class may wake the same neighbour, always with the same value.
  void wake(Index v) { std::atomic_ref(active_[v]).store(1, std::memory_order_relaxed); }
};

} // namespace

void SweepOrder::build(const StarTable& stars, mesh::ThreadPool& pool) {
  const std::size_t n = stars.vertices();
  at_border_.resize(n);
  pool.for_blocks(n, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      at_border_[v] = std::ranges::any_of(stars[static_cast<Index>(v)],
                                          [&](const StarCorner& c) { return c.next < begin || c.next >= end; })
                          ? 1
                          : 0;
    }
  });
  std::vector<Index> border;
  for (std::size_t v = 0; v < n; ++v) {
    if (at_border_[v] != 0) border.push_back(static_cast<Index>(v));
  }
  color(stars, border);
}

// Greedy, in the order of the vertices: few classes, and always the same ones.
void SweepOrder::color(const StarTable& stars, std::span<const Index> border) {
  std::vector<std::uint32_t> count;
  color_.assign(stars.vertices(), uncolored);
  for (const Index v : border) {
    std::uint64_t used = 0;
    for (const StarCorner& c : stars[v]) {
      if (color_[c.next] < 64) used |= std::uint64_t{1} << color_[c.next];
    }
    color_[v] = static_cast<std::uint8_t>(std::countr_one(used));
    if (count.size() <= color_[v]) count.resize(std::size_t{color_[v]} + 1);
    ++count[color_[v]];
  }
  first_.assign(1, 0);
  for (const std::uint32_t n : count) first_.push_back(first_.back() + n);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  border_.resize(border.size());
  for (const Index v : border) border_[next[color_[v]]++] = v;
}

namespace {

template <class Energy>
std::size_t sweep(const Level& level, const Energy& energy, double worthwhile, std::span<Vec3d> points, Active& active,
                  mesh::ThreadPool& pool) {
  std::atomic<std::size_t> moves = 0;
  pool.for_blocks(points.size(), SweepOrder::block_size, [&](std::size_t begin, std::size_t end) {
    Mover mover(level, energy, worthwhile, points, active);
    std::size_t moved = 0;
    for (std::size_t v = begin; v < end; ++v) {
      if (!level.order.is_at_border(static_cast<Index>(v)) && mover.visit(static_cast<Index>(v))) ++moved;
    }
    moves.fetch_add(moved, std::memory_order_relaxed);
  });
  for (std::size_t c = 0; c < level.order.classes(); ++c) {
    const std::span<const Index> members = level.order.members(c);
    pool.for_blocks(members.size(), border_grain, [&](std::size_t begin, std::size_t end) {
      Mover mover(level, energy, worthwhile, points, active);
      std::size_t moved = 0;
      for (const Index v : members.subspan(begin, end - begin)) moved += mover.visit(v) ? 1 : 0;
      moves.fetch_add(moved, std::memory_order_relaxed);
    });
  }
  return moves;
}

} // namespace

std::size_t relax_active(const Level& level, const TriangleEnergy& energy, double worthwhile, std::span<Vec3d> points,
                         Active& active, mesh::ThreadPool& pool) {
  return std::visit([&](const auto& e) { return sweep(level, e, worthwhile, points, active, pool); }, energy);
}

double total_energy(const TriangleEnergy& energy, std::span<const mesh::Triangle> triangles,
                    std::span<const Reference> references, std::span<const Vec3d> points, mesh::ThreadPool& pool) {
  return std::visit(
      [&](const auto& e) {
        return pool.sum_blocks(triangles.size(), triangle_grain, [&](std::size_t begin, std::size_t end) {
          double sum = 0;
          for (std::size_t i = begin; i < end; ++i) {
            const mesh::Triangle& t = triangles[i];
            const StarTerm term = make_term(points[t[1]], points[t[2]], references[i], 0);
            sum += star_energy(e, std::span(&term, 1), points[t[0]]);
          }
          return sum;
        });
      },
      energy);
}

} // namespace orbis::sphere
