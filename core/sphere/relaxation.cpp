#include "core/sphere/relaxation.h"

#include <atomic>
#include <bit>

namespace orbis::sphere {
namespace {

constexpr std::size_t vertex_grain = 512;
constexpr std::size_t triangle_grain = 4096;
constexpr std::uint8_t uncolored = 255;

} // namespace

// Greedy, in the order of the vertices: few classes (7 or 8 on usual meshes), and always the same ones.
void Coloring::build(std::span<const mesh::Index> live, const StarTable& stars) {
  std::vector<std::uint32_t> count;
  for (const mesh::Index v : live) {
    if (color_.size() <= v) color_.resize(std::size_t{v} + 1);
    color_[v] = uncolored;
  }
  for (const mesh::Index v : live) {
    std::uint64_t used = 0;
    for (const StarCorner& c : stars[v]) {
      if (color_[c.next] < 64) used |= std::uint64_t{1} << color_[c.next];
    }
    color_[v] = static_cast<std::uint8_t>(std::countr_one(used));
    if (count.size() <= color_[v]) count.resize(std::size_t{color_[v]} + 1);
    ++count[color_[v]];
  }
  first.assign(1, 0);
  for (const std::uint32_t n : count) first.push_back(first.back() + n);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  vertices.resize(live.size());
  for (const mesh::Index v : live) vertices[next[color_[v]]++] = v;
}

std::size_t relax_active(const Level& level, double worthwhile, std::span<Vec3d> points, Active& active,
                         mesh::ThreadPool& pool) {
  std::atomic<std::size_t> moves = 0;
  // Neighbours of one class may wake the same vertex, always with the same value.
  const auto wake = [&](mesh::Index v) { std::atomic_ref(active[v]).store(1, std::memory_order_relaxed); };
  for (std::size_t color = 0; color + 1 < level.coloring.first.size(); ++color) {
    const std::span<const mesh::Index> members =
        std::span(level.coloring.vertices)
            .subspan(level.coloring.first[color], level.coloring.first[color + 1] - level.coloring.first[color]);
    pool.for_blocks(members.size(), vertex_grain, [&](std::size_t begin, std::size_t end) {
      std::vector<StarTerm> star;
      star.reserve(16);
      std::size_t moved = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const mesh::Index v = members[i];
        if (active[v] == 0) continue;
        gather_star(v, level.stars, level.references, points, star);
        double gain = 0;
        points[v] = newton_step(star, points[v], gain);
        ++moved;
        active[v] = 0;
        if (gain <= worthwhile) continue;
        wake(v);
        for (const StarCorner& c : level.stars[v]) wake(c.next);
      }
      moves.fetch_add(moved, std::memory_order_relaxed);
    });
  }
  return moves;
}

double total_energy(std::span<const mesh::Triangle> triangles, std::span<const Reference> references,
                    std::span<const Vec3d> points, mesh::ThreadPool& pool) {
  return pool.sum_blocks(triangles.size(), triangle_grain, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const mesh::Triangle& t = triangles[i];
      const StarTerm term = make_term(points[t[1]], points[t[2]], references[i], 0);
      sum += star_energy(std::span(&term, 1), points[t[0]]);
    }
    return sum;
  });
}

} // namespace orbis::sphere
