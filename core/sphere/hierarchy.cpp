#include "core/sphere/hierarchy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/mesh/unit_positions.h"
#include "core/sphere/removal_block.h"

namespace orbis::sphere {
namespace {

using mesh::Index;

constexpr std::size_t grain = 4096;
// Vertices of a block; its removals are found by one thread, in one cache.
constexpr std::size_t block_size = 4096;
// Of the candidates of a round, in ascending order of edge length, about this part may go. All of them would make a
// level a uniform subset of the vertices; less lets dense regions go first, as shortest-edge-first does.
constexpr double candidate_quota = 0.7;

// A cost such that at least the quota of the candidates costs no more: the upper end of a histogram's bin. Positive
// floats are in the order of their bits; the upper bits make bins of a 32nd of a power of two.
float quota_cost(std::span<const float> costs) {
  constexpr std::uint32_t bin_bits = 18;
  std::vector<std::uint32_t> count(std::size_t{1} << (32 - bin_bits));
  std::size_t candidates = 0;
  for (const float c : costs) {
    if (c == not_now) continue;
    ++count[std::bit_cast<std::uint32_t>(c) >> bin_bits];
    ++candidates;
  }
  const double quota = std::ceil(static_cast<double>(candidates) * candidate_quota);
  std::size_t sum = 0;
  for (std::uint32_t bin = 0; bin < count.size(); ++bin) {
    sum += count[bin];
    if (static_cast<double>(sum) >= quota) return std::bit_cast<float>((bin << bin_bits) | ((1U << bin_bits) - 1));
  }
  return not_now;
}

// Takes a mesh apart, round by round.
class Decimation {
public:
  Decimation(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool);
  Hierarchy run(Progress& progress);

private:
  void price_vertices();
  void find_removals(std::size_t shift, std::size_t size);
  void record_removals();
  void record(const Removal& removal, std::size_t at, std::size_t ring_at);
  void shrink();

  mesh::ThreadPool& pool_;
  Hierarchy out_;
  // The live mesh, densely numbered in the order of the input, and where its parts stand in the input.
  std::vector<mesh::Triangle> triangles_;
  std::vector<Index> vertices_;
  std::vector<std::uint32_t> slots_;
  std::vector<Vec3d> positions_;
  StarTable stars_;
  std::vector<float> costs_;
  std::vector<std::vector<Removal>> removals_; // by block
  std::vector<VertexState> states_;
  std::vector<std::uint8_t> dead_; // triangles
};

Decimation::Decimation(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool)
    : pool_(pool), triangles_(mesh.triangles), vertices_(mesh.positions.size()), slots_(mesh.triangles.size()),
      positions_(mesh::unit_positions(mesh)) {
  std::iota(vertices_.begin(), vertices_.end(), 0U);
  std::iota(slots_.begin(), slots_.end(), 0U);
  out_.triangles.resize(mesh.triangles.size());
  out_.ring_first.push_back(0);
  out_.block_first.push_back(0);
  out_.round_first.push_back(0);
  out_.round_block.push_back(0);
  out_.removed.reserve(mesh.positions.size());
  out_.ring_first.reserve(mesh.positions.size());
  out_.ring_vertices.reserve(mesh.triangles.size() * 3);
  out_.ring_slots.reserve(mesh.triangles.size() * 3);
}

// The length of the shortest edge, squared.
void Decimation::price_vertices() {
  costs_.resize(vertices_.size());
  pool_.for_blocks(vertices_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<const StarCorner> star = stars_[static_cast<Index>(v)];
      float shortest = not_now;
      if (star.size() <= most_ring_vertices) {
        for (const StarCorner& c : star)
          shortest = std::min(shortest, static_cast<float>(squared_norm(positions_[c.next] - positions_[v])));
      }
      costs_[v] = shortest;
    }
  });
}

// Blocks of consecutive vertices, the first one shorter by the shift, so that a vertex at a block's border in one round
// is inside a block in the next.
void Decimation::find_removals(std::size_t shift, std::size_t size) {
  const std::size_t n = vertices_.size();
  const float most = quota_cost(costs_);
  states_.assign(n, VertexState::free);
  removals_.resize((n + shift + size - 1) / size);
  pool_.for_blocks(removals_.size(), 1, [&](std::size_t block, std::size_t) {
    const std::size_t begin = block == 0 ? 0 : block * size - shift, end = std::min(n, (block + 1) * size - shift);
    removals_[block] = find_independent_removals({stars_, positions_, costs_, most}, {begin, end}, states_);
  });
}

void Decimation::record(const Removal& removal, std::size_t at, std::size_t ring_at) {
  const Ring& ring = removal.ring;
  out_.removed[at] = vertices_[removal.vertex];
  out_.ring_first[at + 1] = static_cast<std::uint32_t>(ring_at + ring.size);
  for (std::size_t k = 0; k < ring.size; ++k) {
    out_.ring_vertices[ring_at + k] = vertices_[ring.vertices[k]];
    out_.ring_slots[ring_at + k] = slots_[ring.triangles[k]];
  }
  for (std::size_t k = 1; k + 1 < ring.size; ++k) {
    triangles_[ring.triangles[k]] = {ring.vertices[0], ring.vertices[k], ring.vertices[k + 1]};
  }
  dead_[ring.triangles[0]] = dead_[ring.triangles[ring.size - 1]] = 1;
}

// Writes the round down, and changes the triangles. The holes of a round share none.
void Decimation::record_removals() {
  std::vector<std::size_t> at{out_.removed.size()}, ring_at{out_.ring_vertices.size()};
  for (const std::vector<Removal>& block : removals_) {
    std::size_t entries = 0;
    for (const Removal& r : block) entries += r.ring.size;
    at.push_back(at.back() + block.size());
    ring_at.push_back(ring_at.back() + entries);
    if (!block.empty()) out_.block_first.push_back(static_cast<std::uint32_t>(at.back()));
  }
  out_.removed.resize(at.back());
  out_.ring_first.resize(at.back() + 1);
  out_.ring_vertices.resize(ring_at.back());
  out_.ring_slots.resize(ring_at.back());
  out_.round_first.push_back(static_cast<std::uint32_t>(at.back()));
  out_.round_block.push_back(static_cast<std::uint32_t>(out_.block_first.size() - 1));
  dead_.assign(triangles_.size(), 0);
  pool_.for_blocks(removals_.size(), 1, [&](std::size_t block, std::size_t) {
    std::size_t i = at[block], entry = ring_at[block];
    for (const Removal& r : removals_[block]) {
      record(r, i++, entry);
      entry += r.ring.size;
    }
  });
}

// Numbers what is still live anew.
void Decimation::shrink() {
  std::vector<Index> number(vertices_.size());
  std::size_t live = 0;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    number[v] = static_cast<Index>(live);
    if (states_[v] == VertexState::removed) continue;
    vertices_[live] = vertices_[v];
    positions_[live] = positions_[v];
    ++live;
  }
  vertices_.resize(live);
  positions_.resize(live);
  live = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (dead_[t] != 0) continue;
    const mesh::Triangle& old = triangles_[t];
    triangles_[live] = {number[old[0]], number[old[1]], number[old[2]]};
    slots_[live] = slots_[t];
    ++live;
  }
  triangles_.resize(live);
  slots_.resize(live);
}

Hierarchy Decimation::run(Progress& progress) {
  const std::uint64_t total = vertices_.size() - 4;
  progress.report(Stage::simplify, 0, total);
  for (std::size_t round = 0; vertices_.size() > 4; ++round) {
    progress.check();
    stars_.build(triangles_, vertices_.size(), pool_);
    price_vertices();
    find_removals(round % 2 * block_size / 2, block_size);
    // Blocks without an inner vertex that may go: the mesh as one block always has one.
    if (std::ranges::all_of(removals_, &std::vector<Removal>::empty)) find_removals(0, vertices_.size());
    record_removals();
    shrink();
    progress.report(Stage::simplify, out_.removed.size(), total);
  }
  std::ranges::copy(vertices_, out_.tetrahedron.begin());
  std::ranges::copy(slots_, out_.tetrahedron_slots.begin());
  for (std::size_t i = 0; i < 4; ++i) {
    const mesh::Triangle& t = triangles_[i];
    out_.triangles[slots_[i]] = {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
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
