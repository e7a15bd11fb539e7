// A cut mesh as it is to be drawn.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/texture/alpha.h"
#include "core/texture/atlas.h"
#include "core/vec3.h"

namespace orbis::texture {

// What triangles look like, but for their texels.
struct Material {
  std::array<float, 4> factor{1, 1, 1, 1}; // what the texels are multiplied by: linear RGB, alpha
  Alpha alpha;
  bool is_double_sided = true; // else only the side is drawn from which the corners go counter-clockwise
  bool is_flat = false;        // by the triangles' own normals
};

struct Shape {
  const CutMesh& mesh;
  std::vector<Vec3d> positions, normals;  // one per vertex
  std::vector<Material> materials;        // empty: one that shows the texels as they are
  std::vector<std::uint32_t> material_of; // by triangle

  [[nodiscard]] const Material& material(std::size_t triangle) const {
    static const Material plain;
    return materials.empty() ? plain : materials[material_of[triangle]];
  }
};

// Normals by the areas of the triangles around each point of the surface, the same at every copy of a point.
[[nodiscard]] std::vector<Vec3d> smooth_normals(const CutMesh& mesh, std::span<const Vec3d> positions);

} // namespace orbis::texture
