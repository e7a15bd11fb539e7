// Any triangles as closed surfaces of genus 0, each triangle once.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/handles.h"
#include "core/mesh/triangle_mesh.h"

namespace orbis::mesh {

// triangle_of for a triangle that was added.
inline constexpr std::uint32_t added_triangle = std::numeric_limits<std::uint32_t>::max();

// One closed, connected, oriented surface of genus 0 without double edges: ranges of the repaired mesh. What comes from
// the soup is in front, what was added to close it behind.
struct ClosedPiece {
  std::uint32_t first_vertex = 0, vertices = 0, soup_vertices = 0;
  std::uint32_t first_triangle = 0, triangles = 0, soup_triangles = 0;
  // As found, before anything was closed or cut but for what could not be one surface:
  std::uint32_t boundary_loops = 0, boundary_edges = 0, genus = 0;
  // What was done:
  std::uint32_t turned_triangles = 0;
  std::uint32_t crack_triangles = 0; // added at T-junctions
  HandleCut handles;
  std::uint32_t caps = 0; // one a boundary loop, those along cuts included
};

struct RepairCounts {
  std::uint64_t shared_edges = 0;       // of three triangles or more, cut apart
  std::uint64_t double_edges = 0;       // that joined the same two vertices as another one, cut apart
  std::uint64_t split_vertices = 0;     // vertices that became more than one, by all cuts but those of handles
  std::uint64_t one_sided_edges = 0;    // cut, since the surface had only one side
  std::uint64_t internal_triangles = 0; // of walls: open pieces with other sheets along all of their boundary
};

struct Repaired {
  TriangleMesh mesh;                      // the pieces one behind the other; they share no vertex
  std::vector<Index> point_of;            // vertex -> point of the soup; added vertices: any number
  std::vector<std::uint32_t> triangle_of; // triangle -> triangle of the soup, or added_triangle
  std::vector<bool> turned;               // by triangle of the soup: corners 1 and 2 changed places
  std::vector<ClosedPiece> pieces;        // in the order of their first triangle
  RepairCounts counts;
};

// positions  of the soup's points
// triangles  of points, no point twice in a triangle
// corners    for each triangle its three vertices in the input: of sheets that meet in an edge those that share them
//            belong together
// tolerance  how far a vertex may lie from another triangle's edge to be on it, in units of the positions
//
// In this order: pairs of triangles are glued along their edges; turned to agree with each other, and cut where no turn
// helps; sheets that meet in one edge are told apart; cracks at T-junctions are closed; double edges and handles are
// cut; and what is open is capped. Every triangle of the soup comes out once, unchanged but for its turn. O(n log n).
[[nodiscard]] Repaired repair(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                              std::span<const Triangle> corners, double tolerance);

} // namespace orbis::mesh
