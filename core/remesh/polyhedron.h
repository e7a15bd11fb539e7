// Regular polyhedra on the unit sphere, subdivided: the connectivity of semi-regular meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/options.h"
#include "core/vec3.h"

namespace orbis::remesh {

// A triangulation of the unit sphere: closed, consistently oriented, counter-clockwise seen from outside.
struct SphereMesh {
  std::vector<Vec3d> points; // unit
  std::vector<mesh::Triangle> triangles;
};

// 8 * 4^times or 20 * 4^times.
[[nodiscard]] std::uint64_t triangles_of(RemeshTarget::Base base, std::uint32_t times);

// The octahedron or icosahedron, each triangle divided into four at its edges' middles `times` times, the new points
// pushed out to the sphere. Every vertex has six neighbours but those of the polyhedron, which keep their four or five.
// Triangle t of one subdivision is 4 t to 4 t + 3 of the next, and the vertices keep their numbers: a hierarchy of
// levels, as wavelets and subdivision surfaces want it.
[[nodiscard]] SphereMesh subdivided(RemeshTarget::Base base, std::uint32_t times);

} // namespace orbis::remesh
