// The triangles of an asset as closed surfaces of genus 0, ready to be unfolded: one component behind the other.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/triangle_mesh.h"
#include "core/report.h"

namespace orbis {

// primitive_of and corners of a cap's triangle; and "none" for a triangle or vertex of the surface.
inline constexpr std::uint32_t no_primitive = std::numeric_limits<std::uint32_t>::max();

// One closed, connected surface of genus 0, with a sphere of its own: ranges of the surface's arrays. What comes from
// the input is in front; the caps, which close its holes and are never delivered, are behind.
struct Component {
  std::uint32_t first_vertex = 0, vertices = 0, input_vertices = 0;
  std::uint32_t first_triangle = 0, triangles = 0, input_triangles = 0;
  std::uint32_t mesh = 0;   // of the document: components never reach across two
  std::uint32_t number = 0; // its place in report.components

  [[nodiscard]] bool has_caps() const { return triangles > input_triangles; }
  [[nodiscard]] std::uint32_t end_vertex() const { return first_vertex + vertices; }
  [[nodiscard]] std::uint32_t end_triangle() const { return first_triangle + triangles; }
};

// A triangle of the input that is delivered but has no place of its own on a sphere.
struct Rider {
  std::uint32_t primitive = 0;
  mesh::Triangle corners{}; // input vertices, all primitives in a row
  // A duplicate: the triangle of the surface that it lies on, corner by corner.
  std::uint32_t twin = no_primitive;
  // Without area, two corners at one position: vertices of the surface there, or no_primitive.
  mesh::Triangle vertices{no_primitive, no_primitive, no_primitive};
};

struct Surface {
  mesh::TriangleMesh mesh;                 // all components, each consistently oriented; they share no vertex
  std::vector<mesh::Triangle> corners;     // triangle of mesh -> its three input vertices, all primitives in a row
  std::vector<std::uint32_t> primitive_of; // triangle of mesh -> primitive of the asset, or no_primitive for a cap
  std::vector<std::uint32_t> first_vertex; // primitive -> its first input vertex in the row
  std::vector<Component> components;       // ascending ranges that cover the mesh
  std::vector<Rider> riders;

  [[nodiscard]] bool is_cap(std::size_t triangle) const { return primitive_of[triangle] == no_primitive; }
};

// A component as a mesh of its own: vertex first_vertex becomes 0, triangle first_triangle 0.
[[nodiscard]] mesh::TriangleMesh mesh_of(const Surface& surface, const Component& component);
// The same without the caps' triangles and vertices: an open surface where there were caps.
[[nodiscard]] mesh::TriangleMesh input_mesh_of(const Surface& surface, const Component& component);

// Welds, classifies and repairs (core/mesh/repair.h), as report.options say. Fills the report's topology, repairs and
// components, and notes what was done. Every triangle of the asset is in the surface once, or a rider. A component
// without extent is left out.
//
// Throws Error: not_genus_zero that says what was found, with topology=strict; invalid_geometry where all triangles are
// degenerate or nothing has extent.
[[nodiscard]] Surface make_surface(const asset::Asset& asset, Report& report);

} // namespace orbis
