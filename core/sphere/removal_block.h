// Which vertices of a block of the mesh can be taken out in one round?
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/sphere/hierarchy.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {

// The cost of a vertex that is not a candidate.
inline constexpr float not_now = std::numeric_limits<float>::infinity();

enum class VertexState : std::uint8_t { free, kept, removed };

// The star of a vertex: (vertex, vertices[k], vertices[k + 1]) is triangle triangles[k].
struct Ring {
  std::size_t size = 0;
  std::array<mesh::Index, most_ring_vertices> vertices{};
  std::array<std::uint32_t, most_ring_vertices> triangles{};
};

// Vertex `vertex` goes by collapsing its edge to ring.vertices[0].
struct Removal {
  mesh::Index vertex;
  Ring ring;
};

// The mesh as a round finds it.
struct Priced {
  const StarTable& stars;
  std::span<const Vec3d> positions;
  std::span<const float> costs; // by vertex; not_now: may not go
  float most;                   // what costs more stays for a later round
};

// Removals of vertices in [block.first, block.second) whose whole ring lies in the block, cheapest first, no two of
// neighbours and none that makes an edge which is there already. At least four vertices stay. Returned in the order of
// the vertices. Touches only the states of the block, so blocks can be searched side by side.
[[nodiscard]] std::vector<Removal>
find_independent_removals(const Priced& mesh, std::pair<std::size_t, std::size_t> block, std::span<VertexState> states);

} // namespace orbis::sphere
