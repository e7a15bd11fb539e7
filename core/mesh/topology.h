// What kind of surface is this? Components, boundaries, genus, and where it is not a manifold.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

struct Topology {
  std::uint64_t vertices = 0, edges = 0, triangles = 0; // of the welded surface; unused vertices do not count
  std::uint32_t components = 0;                         // connected by shared vertices
  std::uint32_t boundary_loops = 0;                     // connected sets of boundary edges
  std::uint64_t boundary_edges = 0;
  std::uint64_t nonmanifold_edges = 0;    // three or more triangles
  std::uint64_t nonmanifold_vertices = 0; // the triangles around it form more than one fan (edges above excepted)
  std::uint64_t duplicate_triangles = 0;  // same three vertices as an earlier one
  bool orientable = true;                 // false: a Moebius strip lies in it
  bool consistently_oriented = true;      // neighbours agree on what is outside, as delivered
  std::int64_t euler_characteristic = 0;  // vertices - edges + triangles
  std::int64_t genus = 0;                 // of a single closed orientable component, else -1
  double signed_volume = 0;               // < 0: inside out; in units of the input, cubed
  std::vector<std::string> where;         // up to a few places: "edge between (…) and (…) has 4 triangles"

  // One closed, orientable, manifold component of Euler characteristic 2.
  [[nodiscard]] bool is_sphere() const;
  // One sentence for a person: what was found and why it is not a sphere; empty where it is one.
  [[nodiscard]] std::string refusal() const;
};

[[nodiscard]] Topology classify(const TriangleMesh& mesh);

// Turns triangles so that all neighbours agree, outward (positive signed volume). Returns the turned triangles'
// numbers; empty where the mesh was consistent already, which is then left as it is, even inside out.
// Requires a closed orientable manifold.
[[nodiscard]] std::vector<std::uint32_t> orient_consistently(TriangleMesh& mesh);

} // namespace orbis::mesh
