// The mesh of the paper's method: collapsed edge by edge to a tetrahedron, and split back.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"

namespace orbis::sphere {

// What one half-edge collapse forgot: `removed` went into `parent`; left and right are the two vertices next to both,
// as seen from removed to parent.
struct Collapse {
  mesh::Index removed, parent, left, right;
};

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

// Vertex numbers are those of the triangle mesh. Throws Error{not_genus_zero} where the triangles are not a closed
// oriented manifold, Error{canceled}.
[[nodiscard]] HalfEdgeMesh make_half_edge_mesh(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& positions,
                                               Progress& progress);

// Collapses the shortest edge first, ties by edge number, until four vertices are left. Each collapse keeps the surface
// a sphere (link condition), removes the end of lower valence and leaves the other where it is.
// Reports Stage::simplify. Throws Error{not_genus_zero} if it gets stuck, which a sphere cannot.
[[nodiscard]] std::vector<Collapse> collapse_to_tetrahedron(HalfEdgeMesh& mesh, Progress& progress);

// Undoes a collapse. They must be undone in reverse order.
void split_vertex(HalfEdgeMesh& mesh, const Collapse& collapse);

// The neighbours of v, counter-clockwise seen from outside: (v, ring[k], ring[k + 1]) is a triangle.
void one_ring(const HalfEdgeMesh& mesh, mesh::Index v, std::vector<mesh::Index>& ring);

} // namespace orbis::sphere
