// All triangles of an asset, their vertices joined where they lie at one point.
#pragma once

#include <cstdint>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/triangle_mesh.h"

namespace orbis {

// A triangle that is delivered but is no part of the surface.
struct LooseTriangle {
  std::uint32_t primitive = 0;
  mesh::Triangle corners{}; // input vertices, all primitives in a row
  mesh::Triangle points{};  // of the soup
};

struct Soup {
  mesh::TriangleMesh mesh;                 // of points; different meshes of the document share none
  std::vector<mesh::Triangle> corners;     // triangle -> its three input vertices, all primitives in a row
  std::vector<std::uint32_t> primitive_of; // triangle -> primitive of the asset
  std::vector<std::uint32_t> first_vertex; // primitive -> its first input vertex in the row
  std::vector<LooseTriangle> degenerate;   // two corners at one point
  std::uint64_t input_triangles = 0, input_vertices = 0, unused_vertices = 0;
};

// Each mesh of the document by itself. An indexed mesh whose indices alone make it closed and manifold is taken as it
// is, coincident vertices and all; others are welded: by exact position, or within a tolerance above 0.
[[nodiscard]] Soup make_soup(const asset::Asset& asset, double weld_tolerance);

// Takes the duplicates out of the soup: triangles with the points of an earlier one, in the same direction and of the
// same material, by their number in the soup as it was.
struct Duplicate {
  LooseTriangle triangle;
  std::uint32_t original = 0; // triangle of the soup as it is afterwards
};
[[nodiscard]] std::vector<Duplicate> take_duplicates(const asset::Asset& asset, Soup& soup);

} // namespace orbis
