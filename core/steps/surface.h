// The triangles of an asset as one surface, ready to be unfolded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "core/report.h"

namespace orbis {

struct Surface {
  mesh::TriangleMesh mesh;             // closed, connected, consistently oriented, genus 0
  std::vector<mesh::Index> vertex_of;  // input vertex, all primitives in a row -> vertex of mesh, or mesh::unreferenced
  std::vector<mesh::Triangle> corners; // triangle of mesh -> its three input vertices
  std::vector<std::uint32_t> primitive_of; // triangle of mesh -> primitive of the asset
  std::vector<std::uint32_t> first_vertex; // primitive -> its first input vertex in the row
};

// Welds, classifies and orients. An indexed mesh whose indices alone make it a sphere is taken as it is, coincident
// vertices and all; others are welded by exact position. Fills the report's topology and notes what was left out or
// turned. Throws Error{not_genus_zero} that says what was found; Error{invalid_geometry} for a surface that is one
// point.
[[nodiscard]] Surface make_surface(const asset::Asset& asset, Report& report);

} // namespace orbis
