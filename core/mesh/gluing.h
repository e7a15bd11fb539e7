// How the triangles of a soup hang together: the one structure that repair edits.
//
// A soup's triangles name points: whatever lies at one position is one point, even where sheets merely touch. Which
// sheets are one surface is said by the gluing alone, half-edge by half-edge. Its vertices are the fans: corners that
// are joined across glued edges. So each vertex is manifold by construction, and to cut a surface open means to unglue
// edges; no triangle ever changes, but for its turn.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

inline constexpr std::uint32_t open_edge = std::numeric_limits<std::uint32_t>::max();

// Half-edge 3 t + k runs from corner k of triangle t to corner (k + 1) mod 3. It is also the name of its first corner.
[[nodiscard]] constexpr std::uint32_t next_in_triangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
[[nodiscard]] constexpr std::uint32_t previous_in_triangle(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

struct Gluing {
  std::vector<Triangle> triangles; // of points
  std::vector<std::uint32_t> twin; // half-edge -> the half-edge that it is glued to, or open_edge

  [[nodiscard]] Index from(std::uint32_t h) const { return triangles[h / 3][h % 3]; }
  [[nodiscard]] Index to(std::uint32_t h) const { return triangles[h / 3][(h + 1) % 3 == 0 ? 0 : h % 3 + 1]; }
  [[nodiscard]] bool is_open(std::uint32_t h) const { return twin[h] == open_edge; }
  void glue(std::uint32_t g, std::uint32_t h) {
    twin[g] = h;
    twin[h] = g;
  }
  // Both sides become boundary.
  void unglue(std::uint32_t h) {
    if (twin[h] != open_edge) twin[twin[h]] = open_edge;
    twin[h] = open_edge;
  }
};

// The sides of edges that more than two triangles share, or two with the same points; edge by edge.
using SharedEdges = std::vector<std::vector<std::uint32_t>>;

// Do two triangles have the same three points? They are then the two sides of one sheet, or one of them is a duplicate:
// never neighbours.
[[nodiscard]] bool have_same_points(const Triangle& s, const Triangle& t);

// Glues every two half-edges that share their edge with no other, whichever way they run; shared edges stay open and
// are returned. triangles: of points, no point twice in a triangle.
struct GluedSoup {
  Gluing gluing;
  SharedEdges shared;
};
[[nodiscard]] GluedSoup glue_pairs(std::span<const Triangle> triangles, std::size_t points);
[[nodiscard]] SharedEdges shared_edges(std::span<const Triangle> triangles, std::size_t points);

// The fans, numbered in the order of their first corner. Requires that glued half-edges run in opposite directions.
struct Fans {
  std::vector<Index> of_corner; // 3 t + k -> fan
  Index count = 0;
};
[[nodiscard]] Fans fans_of(const Gluing& gluing);

// Each boundary loop as its open half-edges, one behind the other; loops in the order of their first half-edge. No fan
// comes twice in a loop. Same requirement.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> boundary_loops(const Gluing& gluing);

// Triangles joined by glued edges: component of each triangle, numbered in the order of their first triangle.
struct Pieces {
  std::vector<std::uint32_t> of_triangle;
  std::uint32_t count = 0;
};
[[nodiscard]] Pieces pieces_of(const Gluing& gluing);

} // namespace orbis::mesh
