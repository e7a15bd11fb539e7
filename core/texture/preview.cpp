#include "core/texture/preview.h"

#include <algorithm>
#include <utility>

#include "core/texture/alignment.h"
#include "core/texture/canvas.h"

namespace orbis::texture {
namespace {

Shape model_shape(const mesh::TriangleMesh& surface, const CutMesh& mesh) {
  std::vector<Vec3d> positions;
  positions.reserve(mesh.vertices.size());
  for (const CutVertex& v : mesh.vertices) {
    Vec3d sum;
    for (std::size_t k = 0; k < 3; ++k)
      sum += Vec3d(surface.positions[surface.triangles[v.triangle][k]]) * v.barycentric[k];
    positions.push_back(sum);
  }
  std::vector<Vec3d> normals = smooth_normals(mesh, positions);
  return {mesh, std::move(positions), std::move(normals)};
}

// Turns the sphere so that each point lies, as far as it goes, on the side of the model that it belongs to.
Rotation towards_model(const CutMesh& mesh, const Shape& model) {
  std::vector<double> area(mesh.vertices.size());
  Vec3d centre;
  double total = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& p = model.positions;
    const double third = norm(cross(p[b] - p[a], p[c] - p[a])) / 6;
    for (const mesh::Index v : {a, b, c}) {
      area[v] += third;
      centre += p[v] * third;
      total += third;
    }
  }
  centre *= total > 0 ? 1 / total : 0;
  std::vector<Vec3d> from, to;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    from.emplace_back(sphere::from_grid(mesh.vertices[v].sphere));
    to.push_back(model.positions[v] - centre);
  }
  return best_rotation(from, to, area);
}

} // namespace

Image draw_model(const mesh::TriangleMesh& surface, const CutMesh& mesh, const Image& atlas, std::uint32_t width,
                 std::uint32_t height) {
  Canvas canvas(width, height);
  canvas.draw(model_shape(surface, mesh), atlas, {0, 0, width, height});
  return canvas.picture();
}

Image draw_sphere(const Image& atlas, std::uint32_t width, std::uint32_t height) {
  Canvas canvas(width, height);
  canvas.draw_sphere(Rotation{}, atlas, {0, 0, width, height});
  return canvas.picture();
}

Image draw_side_by_side(const mesh::TriangleMesh& surface, const CutMesh& mesh, const Image& atlas, std::uint32_t width,
                        std::uint32_t height) {
  Canvas canvas(width, height);
  const Shape model = model_shape(surface, mesh);
  // The model gets the width that it needs at full height, the sphere a square, and what is left over goes around them.
  const double wanted = std::clamp(aspect_of(model), 0.6, 2.0);
  const double side = std::min<double>(height, width / (1 + wanted));
  const auto left = static_cast<std::uint32_t>(side), right = static_cast<std::uint32_t>(wanted * side);
  const std::uint32_t gap = (width - left - right) / 3;
  canvas.draw_sphere(towards_model(mesh, model), atlas, {gap, 0, left, height});
  canvas.draw(model, atlas, {2 * gap + left, 0, right, height});
  return canvas.picture();
}

} // namespace orbis::texture
