// Where on the surface the vertices of a remesh should lie.
#pragma once

#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"
#include "core/remesh/polyhedron.h"
#include "core/remesh/sphere_tree.h"
#include "core/vec3.h"

namespace orbis::remesh {

// A surface and its sphere.
struct MappedSurface {
  std::span<const Vec3d> points; // unit, one per vertex
  std::span<const Vec3f> positions;
  std::span<const mesh::Triangle> triangles;
};

// Moves the points of a triangulation of the sphere so that its image on the surface comes closer to it: an even
// sampling misses the tips of ears and the ridges of edges by as much as its triangles are wide.
//
// The surface's vertices, and points along edges that are long for the sampling, are what the image should pass
// through. A point moves to the place of one of those in its star where that lowers the sum of the fourth powers of
// their distances from the flat triangles that they lie over (so that the largest count most), as long as every
// triangle around it stays positively oriented and none shrinks below a tenth of the star's mean. Largest distances
// first, a few rounds. The triangles stay what they are.
//   tree  of surface.points and surface.triangles
void fit_to_surface(SphereMesh& sampling, const MappedSurface& surface, const SphereTree& tree, mesh::ThreadPool& pool,
                    Progress& progress);

} // namespace orbis::remesh
