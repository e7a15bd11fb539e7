#include "core/sphere/removal_block.h"

#include <algorithm>
#include <bit>

namespace orbis::sphere {
namespace {

using mesh::Index;

Ring ring_of(std::span<const StarCorner> star) {
  Ring ring;
  ring.size = star.size();
  for (std::size_t k = 0; k < star.size(); ++k) {
    ring.vertices[k] = star[k].next;
    ring.triangles[k] = star[k].triangle();
  }
  return ring;
}

void rotate_to(Ring& ring, std::size_t first) {
  const auto by = static_cast<std::ptrdiff_t>(first), n = static_cast<std::ptrdiff_t>(ring.size);
  std::rotate(ring.vertices.begin(), ring.vertices.begin() + by, ring.vertices.begin() + n);
  std::rotate(ring.triangles.begin(), ring.triangles.begin() + by, ring.triangles.begin() + n);
}

// Bit i is set where ring vertex i has an edge, outside the ring, to another ring vertex that is not beside it: it
// cannot be the parent, for that edge would be there twice (the link condition). The ring vertex of the highest degree
// need not be searched: its edges are seen from the other end.
std::uint32_t chorded(const Ring& ring, const StarTable& stars) {
  std::size_t largest = 0;
  for (std::size_t i = 1; i < ring.size; ++i) {
    if (stars.degree(ring.vertices[i]) > stars.degree(ring.vertices[largest])) largest = i;
  }
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (i == largest) continue;
    for (const StarCorner& corner : stars[ring.vertices[i]]) {
      for (std::size_t j = 0; j < ring.size; ++j) {
        const std::size_t apart = j > i ? j - i : i - j;
        if (ring.vertices[j] == corner.next && apart > 1 && apart < ring.size - 1) bits |= 1U << i | 1U << j;
      }
    }
  }
  return bits;
}

// Edges that this round has made, in a hash table with open addressing. A block of n vertices has no more than 2 n
// triangles, and a hole makes fewer edges than it had triangles.
class EdgeSet {
public:
  explicit EdgeSet(std::size_t most_edges) : table_(std::bit_ceil(most_edges + 2)) {}
  [[nodiscard]] bool contains(Index a, Index b) const { return table_[find(key_of(a, b))] != 0; }
  void insert(Index a, Index b) { table_[find(key_of(a, b))] = key_of(a, b); }

private:
  static std::uint64_t key_of(Index a, Index b) { return (std::uint64_t{std::max(a, b)} << 32) | std::min(a, b); }
  [[nodiscard]] std::size_t find(std::uint64_t key) const {
    const std::size_t mask = table_.size() - 1;
    std::size_t at = (key * 0x9E3779B97F4A7C15ULL >> 20) & mask;
    while (table_[at] != 0 && table_[at] != key) at = (at + 1) & mask;
    return at;
  }
  std::vector<std::uint64_t> table_; // 0: free; no edge has key 0, since its larger vertex is not 0
};

class Search {
public:
  Search(const Priced& mesh, std::pair<std::size_t, std::size_t> block, std::span<VertexState> states)
      : mesh_(mesh), begin_(block.first), end_(block.second), states_(states), new_edges_(2 * (end_ - begin_)) {}

  std::vector<Removal> run() {
    for (const Index v : candidates()) {
      if (end_ - begin_ - removals_.size() <= 4) break;
      if (states_[v] == VertexState::free) try_removal(v);
    }
    std::ranges::sort(removals_, {}, &Removal::vertex);
    return std::move(removals_);
  }

private:
  const Priced& mesh_;
  std::size_t begin_, end_;
  std::span<VertexState> states_;
  EdgeSet new_edges_;
  std::vector<Removal> removals_;

  // Cheapest first.
  [[nodiscard]] std::vector<Index> candidates() const {
    std::vector<std::pair<float, Index>> found;
    for (std::size_t v = begin_; v < end_; ++v) {
      if (mesh_.costs[v] <= mesh_.most && mesh_.costs[v] != not_now && is_inside(static_cast<Index>(v)))
        found.emplace_back(mesh_.costs[v], static_cast<Index>(v));
    }
    std::ranges::sort(found);
    std::vector<Index> out(found.size());
    std::ranges::transform(found, out.begin(), &std::pair<float, Index>::second);
    return out;
  }

  [[nodiscard]] bool is_inside(Index v) const {
    return std::ranges::all_of(mesh_.stars[v], [&](const StarCorner& c) { return c.next >= begin_ && c.next < end_; });
  }

  void try_removal(Index v) {
    const Ring ring = ring_from_parent(v);
    if (!claim_edges(ring)) return;
    states_[v] = VertexState::removed;
    for (std::size_t k = 0; k < ring.size; ++k) states_[ring.vertices[k]] = VertexState::kept;
    removals_.push_back({v, ring});
  }

  // The ring of v, from its nearest legal parent on: there always is one.
  [[nodiscard]] Ring ring_from_parent(Index v) const {
    Ring ring = ring_of(mesh_.stars[v]);
    const std::uint32_t illegal = chorded(ring, mesh_.stars);
    std::size_t parent = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < ring.size; ++k) {
      const double length = squared_norm(mesh_.positions[ring.vertices[k]] - mesh_.positions[v]);
      if ((illegal >> k & 1U) != 0 || length >= shortest) continue;
      shortest = length;
      parent = k;
    }
    rotate_to(ring, parent);
    return ring;
  }

  // Takes the ring's new edges, all from its first vertex, unless this round has made one of them already.
  [[nodiscard]] bool claim_edges(const Ring& ring) {
    for (std::size_t k = 2; k + 1 < ring.size; ++k) {
      if (new_edges_.contains(ring.vertices[0], ring.vertices[k])) return false;
    }
    for (std::size_t k = 2; k + 1 < ring.size; ++k) new_edges_.insert(ring.vertices[0], ring.vertices[k]);
    return true;
  }
};

} // namespace

std::vector<Removal> find_independent_removals(const Priced& mesh, std::pair<std::size_t, std::size_t> block,
                                               std::span<VertexState> states) {
  return Search(mesh, block, states).run();
}

} // namespace orbis::sphere
