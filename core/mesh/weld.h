// Vertices that were split at UV, normal or material seams, joined again for the topology.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

// vertex_of for a vertex that no triangle uses.
inline constexpr Index unreferenced = 0xFFFFFFFF;

struct Welded {
  TriangleMesh mesh;                      // every vertex is used, no triangle repeats a vertex
  std::vector<Index> vertex_of;           // input vertex -> vertex of mesh, or `unreferenced`
  std::vector<std::uint32_t> triangle_of; // welded triangle -> input triangle
  std::vector<std::uint32_t> degenerate;  // input triangles left out: two corners became one vertex
};

// Joins vertices whose positions are equal (-0 equals 0). Vertices keep the order of their first appearance.
// triangles: indices into positions, all in range. O(n).
[[nodiscard]] Welded weld(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

// Joins vertices that are no farther apart than the tolerance: each goes to the nearest of the vertices before it that
// were not joined themselves, so that chains do not form, and takes its position. tolerance > 0, in units of the
// positions. O(n).
[[nodiscard]] Welded weld_within(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                                 double tolerance);

// The same shape, but every input vertex stays its own: for meshes whose indices alone say what is connected.
[[nodiscard]] Welded keep_indices(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

} // namespace orbis::mesh
