// A mesh renumbered so that what is close together on the surface is close together in memory.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

// The vertices in the order in which a Hilbert curve of 2^13 steps a side visits them; those in one cell in the order
// of their numbers. positions: within the unit cube.
[[nodiscard]] std::vector<Index> hilbert_order(std::span<const Vec3d> positions, ThreadPool& pool);

// The same triangles with vertex order[i] called i: each with its lowest vertex first, in ascending order. Two meshes
// that differ only in the numbering of their vertices, triangles and corners come out the same, unless two vertices
// share a cell.
[[nodiscard]] std::vector<Triangle> renumbered(std::span<const Triangle> triangles, std::span<const Index> order,
                                               ThreadPool& pool);

} // namespace orbis::mesh
