#include "core/sphere/hierarchy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/mesh/unit_positions.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {
namespace {

using mesh::Index;
using mesh::Triangle;

// Of the candidates of a round, in ascending order of edge length, this part may go. All of them would make a level
// a uniform subset of the vertices; less lets dense regions go first, as shortest-edge-first does.
constexpr double candidate_quota = 0.7;

struct Ring {
  std::size_t size = 0;
  std::array<Index, most_ring_vertices> vertices{};
  std::array<std::uint32_t, most_ring_vertices> slots{};
};

// The star of v in counter-clockwise order, starting anywhere.
Ring ring_of(std::span<const StarCorner> star) {
  Ring ring;
  ring.size = star.size();
  std::size_t at = 0;
  for (std::size_t k = 0; k < star.size(); ++k) {
    ring.vertices[k] = star[at].next;
    ring.slots[k] = star[at].slot();
    const Index next = star[at].previous;
    for (std::size_t i = 0; i < star.size(); ++i) {
      if (star[i].next == next) {
        at = i;
        break;
      }
    }
  }
  return ring;
}

void rotate_to(Ring& ring, std::size_t first) {
  const auto by = static_cast<std::ptrdiff_t>(first), n = static_cast<std::ptrdiff_t>(ring.size);
  std::rotate(ring.vertices.begin(), ring.vertices.begin() + by, ring.vertices.begin() + n);
  std::rotate(ring.slots.begin(), ring.slots.begin() + by, ring.slots.begin() + n);
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

// Edges that this round has made, in a hash table with open addressing.
class EdgeSet {
public:
  void reset(std::size_t most_edges) { table_.assign(std::bit_ceil(most_edges * 2 + 2), 0); }
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

struct Candidate {
  float cost; // the length of its shortest edge
  Index vertex;
};

constexpr float not_now = std::numeric_limits<float>::infinity();

// Takes a mesh apart, round by round.
class Decimation {
public:
  Decimation(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool);
  Hierarchy run(Progress& progress);

private:
  void find_candidates();
  [[nodiscard]] Candidate candidate(Index v) const;
  void remove_independent();
  [[nodiscard]] Ring ring_from_parent(Index v) const;
  [[nodiscard]] bool claim_edges(const Ring& ring);
  void remove(Index v, const Ring& ring);
  void drop_dead();

  std::vector<Vec3d> positions_; // brought to the unit cube
  mesh::ThreadPool& pool_;
  Hierarchy out_;
  StarTable stars_;
  std::vector<Index> vertices_;      // live
  std::vector<std::uint32_t> slots_; // live
  std::vector<Candidate> candidates_;
  std::vector<std::pair<Index, Ring>> accepted_; // of this round
  std::vector<std::uint32_t> dead_slots_;
  std::vector<std::uint8_t> state_; // by vertex: free, kept in this round, removed
  EdgeSet new_edges_;
};

enum : std::uint8_t { vertex_free, vertex_kept, vertex_removed };
constexpr Index dead_triangle = std::numeric_limits<Index>::max();

Decimation::Decimation(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool) : pool_(pool) {
  positions_ = mesh::unit_positions(mesh);
  out_.triangles = mesh.triangles;
  out_.ring_first.push_back(0);
  out_.round_first.push_back(0);
  vertices_.resize(mesh.positions.size());
  std::iota(vertices_.begin(), vertices_.end(), 0U);
  slots_.resize(mesh.triangles.size());
  std::iota(slots_.begin(), slots_.end(), 0U);
  state_.assign(mesh.positions.size(), vertex_free);
  out_.removed.reserve(mesh.positions.size());
  out_.ring_first.reserve(mesh.positions.size());
  out_.ring_vertices.reserve(mesh.triangles.size() * 3);
  out_.ring_slots.reserve(mesh.triangles.size() * 3);
}

Candidate Decimation::candidate(Index v) const {
  const std::span<const StarCorner> star = stars_[v];
  if (star.size() > most_ring_vertices) return {not_now, v};
  double shortest = squared_norm(positions_[star[0].next] - positions_[v]);
  for (const StarCorner& c : star) shortest = std::min(shortest, squared_norm(positions_[c.next] - positions_[v]));
  return {static_cast<float>(std::sqrt(shortest)), v};
}

void Decimation::find_candidates() {
  stars_.build(out_.triangles, slots_, positions_.size());
  candidates_.resize(vertices_.size());
  pool_.for_blocks(vertices_.size(), 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) candidates_[i] = candidate(vertices_[i]);
  });
  std::erase_if(candidates_, [](const Candidate& c) { return c.cost == not_now; });
  const auto quota = static_cast<std::ptrdiff_t>(std::ceil(static_cast<double>(candidates_.size()) * candidate_quota));
  const auto order = [](const Candidate& a, const Candidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.vertex < b.vertex;
  };
  std::nth_element(candidates_.begin(), candidates_.begin() + quota - 1, candidates_.end(), order);
  candidates_.resize(static_cast<std::size_t>(quota));
  std::sort(candidates_.begin(), candidates_.end(), order);
}

// Takes the ring's new edges, all from its first vertex, unless this round has made one of them already.
bool Decimation::claim_edges(const Ring& ring) {
  for (std::size_t k = 2; k + 1 < ring.size; ++k) {
    if (new_edges_.contains(ring.vertices[0], ring.vertices[k])) return false;
  }
  for (std::size_t k = 2; k + 1 < ring.size; ++k) new_edges_.insert(ring.vertices[0], ring.vertices[k]);
  return true;
}

// The ring of v, from its nearest legal parent on: there always is one.
Ring Decimation::ring_from_parent(Index v) const {
  Ring ring = ring_of(stars_[v]);
  const std::uint32_t illegal = chorded(ring, stars_);
  std::size_t parent = 0;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < ring.size; ++k) {
    const double length = squared_norm(positions_[ring.vertices[k]] - positions_[v]);
    if ((illegal >> k & 1U) != 0 || length >= shortest) continue;
    shortest = length;
    parent = k;
  }
  rotate_to(ring, parent);
  return ring;
}

void Decimation::remove(Index v, const Ring& ring) {
  out_.removed.push_back(v);
  out_.ring_vertices.insert(out_.ring_vertices.end(), ring.vertices.begin(), ring.vertices.begin() + ring.size);
  out_.ring_slots.insert(out_.ring_slots.end(), ring.slots.begin(), ring.slots.begin() + ring.size);
  out_.ring_first.push_back(static_cast<std::uint32_t>(out_.ring_vertices.size()));
  for (std::size_t k = 1; k + 1 < ring.size; ++k) {
    out_.triangles[ring.slots[k]] = {ring.vertices[0], ring.vertices[k], ring.vertices[k + 1]};
  }
  out_.triangles[ring.slots[0]][0] = dead_triangle;
  out_.triangles[ring.slots[ring.size - 1]][0] = dead_triangle;
}

void Decimation::remove_independent() {
  new_edges_.reset(slots_.size() / 2);
  accepted_.clear();
  for (const Candidate& c : candidates_) {
    if (vertices_.size() - accepted_.size() == 4) break;
    if (state_[c.vertex] != vertex_free) continue;
    const Ring ring = ring_from_parent(c.vertex);
    if (!claim_edges(ring)) continue;
    state_[c.vertex] = vertex_removed;
    for (std::size_t k = 0; k < ring.size; ++k) state_[ring.vertices[k]] = vertex_kept;
    accepted_.emplace_back(c.vertex, ring);
  }
  // In the order of the input, where neighbours are close together: what comes after walks the records front to back.
  std::ranges::sort(accepted_, {}, &std::pair<Index, Ring>::first);
  for (const auto& [v, ring] : accepted_) remove(v, ring);
  out_.round_first.push_back(static_cast<std::uint32_t>(out_.removed.size()));
}

void Decimation::drop_dead() {
  std::erase_if(vertices_, [&](Index v) { return state_[v] == vertex_removed; });
  std::erase_if(slots_, [&](std::uint32_t s) { return out_.triangles[s][0] == dead_triangle; });
  for (const Index v : vertices_) state_[v] = vertex_free;
}

Hierarchy Decimation::run(Progress& progress) {
  const std::uint64_t total = vertices_.size() - 4;
  progress.report(Stage::simplify, 0, total);
  while (vertices_.size() > 4) {
    progress.check();
    find_candidates();
    remove_independent();
    drop_dead();
    progress.report(Stage::simplify, out_.removed.size(), total);
  }
  std::copy(vertices_.begin(), vertices_.end(), out_.tetrahedron.begin());
  std::copy(slots_.begin(), slots_.end(), out_.tetrahedron_slots.begin());
  return std::move(out_);
}

} // namespace

void Hierarchy::undo(std::size_t i) {
  const auto vertices = ring(i);
  const auto places = slots(i);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    triangles[places[k]] = {removed[i], vertices[k], vertices[(k + 1) % vertices.size()]};
  }
}

Hierarchy build_hierarchy(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool, Progress& progress) {
  return Decimation(mesh, pool).run(progress);
}

} // namespace orbis::sphere
