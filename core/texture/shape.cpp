#include "core/texture/shape.h"

namespace orbis::texture {

std::vector<Vec3d> smooth_normals(const CutMesh& mesh, std::span<const Vec3d> positions) {
  std::vector<Vec3d> at_point(mesh.points);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d area = cross(positions[b] - positions[a], positions[c] - positions[a]);
    for (const mesh::Index v : {a, b, c}) at_point[mesh.vertices[v].point] += area;
  }
  std::vector<Vec3d> normals;
  normals.reserve(mesh.vertices.size());
  for (const CutVertex& v : mesh.vertices) {
    const double length = norm(at_point[v.point]);
    normals.push_back(length > 0 ? at_point[v.point] * (1 / length) : Vec3d{0, 0, 1});
  }
  return normals;
}

} // namespace orbis::texture
