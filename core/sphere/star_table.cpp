#include "core/sphere/star_table.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace orbis::sphere {
namespace {

using mesh::Index;
using mesh::Triangle;

constexpr std::size_t grain = 4096;
// Larger stars are put in order by a sorted list of their neighbours instead of by looking at each.
constexpr std::size_t large_star = 24;

// Two threads never add to one counter in an order that shows: the rows are put in order afterwards.
std::uint32_t add(std::uint32_t& counter, std::uint32_t by, bool alone) {
  if (alone) return std::exchange(counter, counter + by);
  return std::atomic_ref(counter).fetch_add(by, std::memory_order_relaxed);
}

Index third(std::span<const Triangle> triangles, const StarCorner& c) {
  return triangles[c.triangle()][(c.place() + 2) % 3];
}

// Each corner's follower is the one whose `next` is its third vertex.
void order_small(std::span<StarCorner> star, std::span<const Triangle> triangles) {
  for (std::size_t k = 0; k + 2 < star.size(); ++k) {
    const Index wanted = third(triangles, star[k]);
    for (std::size_t i = k + 1; i < star.size(); ++i) {
      if (star[i].next == wanted) {
        std::swap(star[k + 1], star[i]);
        break;
      }
    }
  }
}

void order_large(std::span<StarCorner> star, std::span<const Triangle> triangles) {
  std::vector<StarCorner> by_next(star.begin(), star.end());
  std::ranges::sort(by_next, {}, &StarCorner::next);
  for (std::size_t k = 0; k + 1 < star.size(); ++k) {
    const Index wanted = third(triangles, star[k]);
    const auto follower = std::ranges::lower_bound(by_next, wanted, {}, &StarCorner::next);
    if (follower != by_next.end()) star[k + 1] = *follower;
  }
}

void order(std::span<StarCorner> star, std::span<const Triangle> triangles) {
  if (star.empty()) return;
  std::swap(star[0], *std::ranges::min_element(star, {}, &StarCorner::corner));
  if (star.size() < large_star)
    order_small(star, triangles);
  else
    order_large(star, triangles);
}

} // namespace

void StarTable::count_and_fill(std::span<const Triangle> triangles, mesh::ThreadPool& pool) {
  const bool alone = pool.size() == 1;
  pool.for_blocks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (const Index v : triangles[t]) add(first_[v], 1, alone);
    }
  });
  // first_[v] becomes the end of row v, then walks back to its start as the row is filled.
  std::uint32_t end = 0;
  for (std::uint32_t& f : first_) f = end += f;
  pool.for_blocks(triangles.size(), grain, [&](std::size_t begin, std::size_t last) {
    for (std::size_t t = begin; t < last; ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t at = add(first_[triangles[t][k]], ~0U, alone) - 1;
        corners_[at] = {triangles[t][(k + 1) % 3], static_cast<std::uint32_t>(4 * t) + k};
      }
    }
  });
}

void StarTable::build(std::span<const Triangle> triangles, std::size_t vertex_count, mesh::ThreadPool& pool) {
  first_.assign(vertex_count + 1, 0);
  corners_.resize(triangles.size() * 3);
  count_and_fill(triangles, pool);
  pool.for_blocks(vertex_count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      order(std::span(corners_).subspan(first_[v], first_[v + 1] - first_[v]), triangles);
    }
  });
}

} // namespace orbis::sphere
