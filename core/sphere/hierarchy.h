// A closed genus-0 mesh, taken apart to a tetrahedron in rounds of independent vertex removals.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"

namespace orbis::sphere {

// Rings of more vertices are left for a later round, when their neighbours are fewer. A closed triangulation always
// has a vertex of degree 5 or less, and a vertex of any degree has a legal parent: the edges outside its ring form an
// outerplanar graph, of which at least two vertices have no edge.
inline constexpr std::size_t most_ring_vertices = 16;

// Removal i takes vertex removed[i] out by collapsing the edge to its parent, ring(i)[0]: the hole, a polygon of d
// vertices in counter-clockwise order, is filled with the fan of the parent. The triangles keep their slots in the
// input's array: slot(i)[k] held (removed, ring[k], ring[k+1]) before; after, slots 1 .. d-2 hold (ring[0], ring[k],
// ring[k+1]), and slots 0 and d-1 are free.
//
// No two vertices of one round are neighbours, so its holes share no triangle: undoing a round is a set of independent
// insertions, each a point in the kernel of its polygon. The removals of a round come in blocks, and no ring shares a
// vertex with a ring of another block.
struct Hierarchy {
  std::array<mesh::Index, 4> tetrahedron{}; // the four vertices that are left
  std::array<std::uint32_t, 4> tetrahedron_slots{};
  std::vector<mesh::Triangle> triangles; // by slot; only the four live slots mean something at the coarsest level
  std::vector<mesh::Index> removed;
  std::vector<std::uint32_t>
      ring_first; // removal -> its first entry in ring_vertices and ring_slots; one past the end too
  std::vector<mesh::Index> ring_vertices;
  std::vector<std::uint32_t> ring_slots;
  std::vector<std::uint32_t> block_first; // block -> its first removal; one past the end too
  std::vector<std::uint32_t> round_first; // round -> its first removal; one past the end too
  std::vector<std::uint32_t> round_block; // round -> its first block; one past the end too

  [[nodiscard]] std::span<const mesh::Index> ring(std::size_t i) const {
    return std::span(ring_vertices).subspan(ring_first[i], ring_first[i + 1] - ring_first[i]);
  }
  [[nodiscard]] std::span<const std::uint32_t> slots(std::size_t i) const {
    return std::span(ring_slots).subspan(ring_first[i], ring_first[i + 1] - ring_first[i]);
  }
  [[nodiscard]] std::size_t rounds() const { return round_first.size() - 1; }

  // Writes the triangles that removal i had taken away or changed back into their slots.
  void undo(std::size_t i);
};

// Shortest edges first, within each round. Requires what embed_isometric requires.
// Reports Stage::simplify. Throws Error{canceled}.
[[nodiscard]] Hierarchy build_hierarchy(const mesh::TriangleMesh& mesh, mesh::ThreadPool& pool, Progress& progress);

} // namespace orbis::sphere
