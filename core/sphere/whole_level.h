#pragma once

#include <span>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"
#include "core/sphere/triangle_energy.h"

namespace orbis::sphere {

// A level of detail, all of it.
struct WholeLevel {
  const TriangleEnergy& energy;
  std::span<const mesh::Triangle> triangles;
  const StarTable& stars;
  std::span<const Reference> references;
};

} // namespace orbis::sphere
