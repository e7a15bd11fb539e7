// Handles cut open, along short loops, until what is left is a sphere with holes.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/gluing.h"

namespace orbis::mesh {

struct HandleCut {
  std::uint64_t loops = 0, edges = 0; // that were unglued
  double length = 0;                  // of the edges, in units of the positions
};

// Cuts one connected piece along one loop a handle. The loops come from a tree-cotree decomposition (Eppstein 2003;
// Erickson and Whittlesey, Greedy optimal homotopy and homology generators, 2005): the shortest paths from one vertex
// make a tree; the dual edges that avoid it, farthest first, another; each of the 2 g edges in neither closes a loop of
// two shortest paths. As a homology basis they are independent, so any of them that share no vertex can be cut at once
// and leave the piece connected. While time permits, the tree is grown again from the shortest loop found, until none
// is shorter, and only the shortest are cut; on large pieces with many handles all that share no vertex are cut at
// once. The rest is left to the next round, from another vertex.
//
// A loop may follow a boundary for a while, and what is cut with it then comes apart: the work ends there, before genus
// 0 is reached perhaps, and is to be gone on with for each part.
//   triangles  those of the piece, in ascending order
// O(rounds n log n); rounds are few, since handles far apart are cut in the same one.
[[nodiscard]] HandleCut cut_handles(std::span<const Vec3f> positions, std::span<const std::uint32_t> triangles,
                                    Gluing& gluing);

} // namespace orbis::mesh
