// What a triangle should look like: its shape and size on the surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"

namespace orbis::sphere {

// Of one triangle: the cotangents of its angles, corner by corner, and its area, all areas together 4 pi.
struct Reference {
  std::array<float, 3> cot{};
  float area = 0;
};

// References of the triangles of one level of detail.
//   regularisation  this part of the mean squared edge length is added to a triangle's three squared lengths, which
//                   turns slivers into triangles with finite cotangents; 0 < regularisation
// Areas below a millionth of the mean are raised to it: what is smaller could not be told apart on the grid of the
// delivered coordinates.
void compute_references(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                        double regularisation, mesh::ThreadPool& pool, std::vector<Reference>& out);

} // namespace orbis::sphere
