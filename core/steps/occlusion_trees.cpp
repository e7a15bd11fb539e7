#include "core/steps/occlusion_trees.h"

#include <algorithm>
#include <map>

namespace orbis {
namespace {

float size_of(const std::vector<Vec3f>& positions) {
  Vec3f low = positions.front(), high = low;
  for (const Vec3f& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

} // namespace

OcclusionTrees occlusion_trees(const Surface& surface, const texture::CutMesh& cut) {
  std::map<std::uint32_t, std::vector<mesh::Triangle>> triangles; // by mesh of the document
  std::vector<std::uint32_t> mesh_of(surface.mesh.triangles.size());
  for (const Component& c : surface.components) {
    for (std::uint32_t t = c.first_triangle; t < c.end_triangle(); ++t) {
      mesh_of[t] = c.mesh;
      if (!surface.is_cap(t)) triangles[c.mesh].push_back(surface.mesh.triangles[t]);
    }
  }
  OcclusionTrees out;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const auto& [mesh, list] : triangles) {
    number[mesh] = static_cast<std::uint32_t>(out.trees.size());
    out.trees.emplace_back(surface.mesh.positions, list);
  }
  for (const std::uint32_t parent : cut.parent) out.tree_of.push_back(number.at(mesh_of[parent]));
  constexpr float part = 1e-5F;
  out.offset = part * size_of(surface.mesh.positions);
  return out;
}

} // namespace orbis
