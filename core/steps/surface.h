// The triangles of an asset as closed surfaces of genus 0, ready to be unfolded: one component behind the other.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "core/report.h"

namespace orbis {

// primitive_of and corners of a cap's triangle.
inline constexpr std::uint32_t no_primitive = std::numeric_limits<std::uint32_t>::max();

// One closed, connected surface of genus 0, with a sphere of its own: ranges of the surface's arrays. What comes from
// the input is in front; the caps, which close its holes and are never delivered, are behind.
struct Component {
  std::uint32_t first_vertex = 0, vertices = 0, input_vertices = 0;
  std::uint32_t first_triangle = 0, triangles = 0, input_triangles = 0;
  std::uint32_t mesh = 0; // of the document: components never reach across two

  [[nodiscard]] bool has_caps() const { return triangles > input_triangles; }
  [[nodiscard]] std::uint32_t end_vertex() const { return first_vertex + vertices; }
  [[nodiscard]] std::uint32_t end_triangle() const { return first_triangle + triangles; }
};

struct Surface {
  mesh::TriangleMesh mesh;                 // all components, each consistently oriented; they share no vertex
  std::vector<mesh::Triangle> corners;     // triangle of mesh -> its three input vertices, all primitives in a row
  std::vector<std::uint32_t> primitive_of; // triangle of mesh -> primitive of the asset, or no_primitive for a cap
  std::vector<std::uint32_t> first_vertex; // primitive -> its first input vertex in the row
  std::vector<Component> components;       // ascending ranges that cover the mesh

  [[nodiscard]] bool is_cap(std::size_t triangle) const { return primitive_of[triangle] == no_primitive; }
};

// A component as a mesh of its own: vertex first_vertex becomes 0, triangle first_triangle 0.
[[nodiscard]] mesh::TriangleMesh mesh_of(const Surface& surface, const Component& component);
// The same without the caps' triangles and vertices: an open surface where there were caps.
[[nodiscard]] mesh::TriangleMesh input_mesh_of(const Surface& surface, const Component& component);

// Welds, classifies and orients, each mesh of the document by itself. An indexed mesh whose indices alone make it a
// sphere is taken as it is, coincident vertices and all; others are welded by exact position. Fills the report's
// topology and notes what was left out or turned. Throws Error{not_genus_zero} that says what was found;
// Error{invalid_geometry} for a surface that is one point.
[[nodiscard]] Surface make_surface(const asset::Asset& asset, Report& report);

} // namespace orbis
