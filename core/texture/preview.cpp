#include "core/texture/preview.h"

#include <algorithm>
#include <utility>

#include "core/texture/alignment.h"
#include "core/texture/canvas.h"

namespace orbis::texture {
namespace {

std::uint32_t component_with_most_texels(const CutMesh& mesh) {
  std::vector<double> texels;
  for (const Chart& c : mesh.charts) {
    if (c.component >= texels.size()) texels.resize(c.component + 1);
    texels[c.component] += static_cast<double>(c.width) * c.height;
  }
  return static_cast<std::uint32_t>(std::max_element(texels.begin(), texels.end()) - texels.begin());
}

// One component's triangles on its sphere, split until they look round. Both sides are drawn: through the holes of an
// open component its sphere is seen from within.
class RoundMesh {
public:
  // model: gives the materials; null: the texels are shown as they are.
  RoundMesh(const CutMesh& mesh, std::uint32_t component, const Shape* model) {
    mesh_.charts = mesh.charts;
    mesh_.pages = mesh.pages;
    mesh_.points = mesh.points;
    mesh_.vertices = mesh.vertices;
    for (const CutVertex& v : mesh.vertices) points_.push_back(normalized(Vec3d(sphere::from_grid(v.sphere))));
    if (model != nullptr) materials_ = model->materials;
    for (Material& material : materials_) {
      material.is_double_sided = true;
      material.is_flat = false;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.charts[mesh.chart[t]].component == component) {
        split(mesh.triangles[t], mesh.chart[t]);
        if (!materials_.empty()) material_of_.resize(mesh_.triangles.size(), model->material_of[t]);
      }
  }

  [[nodiscard]] Shape shape(const Rotation& rotation) const {
    Shape out{mesh_, {}, {}, materials_, material_of_};
    for (const Vec3d& p : points_) out.positions.push_back(rotation(p));
    out.normals = out.positions;
    return out;
  }

private:
  CutMesh mesh_;
  std::vector<Vec3d> points_;
  std::vector<Material> materials_;
  std::vector<std::uint32_t> material_of_;

  // The longest edge is halved while it is too long. Whether an edge is does not depend on the triangle, so neighbours
  // agree.
  void split(const mesh::Triangle& triangle, std::uint32_t chart) {
    constexpr double longest_edge = 0.06; // radians
    std::size_t longest = 0;
    std::array<double, 3> length{};
    for (std::size_t k = 0; k < 3; ++k) {
      length[k] = squared_norm(points_[triangle[k]] - points_[triangle[(k + 1) % 3]]);
      if (length[k] > length[longest]) longest = k;
    }
    if (length[longest] <= longest_edge * longest_edge) {
      mesh_.triangles.push_back(triangle);
      mesh_.chart.push_back(chart);
      return;
    }
    const mesh::Index a = triangle[longest], b = triangle[(longest + 1) % 3], c = triangle[(longest + 2) % 3];
    const mesh::Index middle = halfway(a, b);
    split({a, middle, c}, chart);
    split({middle, b, c}, chart);
  }

  // Texture coordinates follow the chord, as they do in the triangle.
  mesh::Index halfway(mesh::Index a, mesh::Index b) {
    const Vec3d p =
        Vec3d(sphere::from_grid(mesh_.vertices[a].sphere)) + Vec3d(sphere::from_grid(mesh_.vertices[b].sphere));
    CutVertex v = mesh_.vertices[a];
    const Vec2f &u = mesh_.vertices[a].uv, &w = mesh_.vertices[b].uv;
    v.uv = {(u.x + w.x) / 2, (u.y + w.y) / 2};
    v.sphere = sphere::to_grid(p * 0.5);
    mesh_.vertices.push_back(v);
    points_.push_back(normalized(p));
    return static_cast<mesh::Index>(points_.size() - 1);
  }
};

// Turns the sphere so that each point lies, as far as it goes, on the side of the model that it belongs to.
Rotation towards_model(const CutMesh& mesh, const Shape& model, std::uint32_t component) {
  std::vector<double> area(mesh.vertices.size());
  Vec3d centre;
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.charts[mesh.chart[t]].component != component) continue;
    const auto& [a, b, c] = mesh.triangles[t];
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

Shape shape_of(const mesh::TriangleMesh& surface, const CutMesh& mesh) {
  std::vector<Vec3d> positions;
  positions.reserve(mesh.vertices.size());
  for (const CutVertex& v : mesh.vertices) positions.push_back(interpolated(surface.positions, surface.triangles, v));
  std::vector<Vec3d> normals = smooth_normals(mesh, positions);
  return {mesh, std::move(positions), std::move(normals), {}, {}};
}

Image draw_model(const mesh::TriangleMesh& surface, const CutMesh& mesh, std::span<const Image> pages,
                 std::uint32_t width, std::uint32_t height, mesh::ThreadPool& pool) {
  Canvas canvas(width, height, pages, pool);
  canvas.draw(shape_of(surface, mesh), {0, 0, width, height});
  return canvas.picture();
}

Image draw_sphere(const CutMesh& mesh, std::span<const Image> pages, std::uint32_t width, std::uint32_t height,
                  mesh::ThreadPool& pool) {
  Canvas canvas(width, height, pages, pool);
  const RoundMesh round(mesh, component_with_most_texels(mesh), nullptr);
  canvas.draw(round.shape(Rotation{}), {0, 0, width, height});
  return canvas.picture();
}

Image draw_side_by_side(const CutMesh& mesh, const Shape& model, std::span<const Image> pages, std::uint32_t width,
                        std::uint32_t height, mesh::ThreadPool& pool) {
  Canvas canvas(width, height, pages, pool);
  const std::uint32_t component = component_with_most_texels(mesh);
  const RoundMesh round(mesh, component, &model);
  // The model gets the width that it needs at full height, the sphere a square, and what is left over goes around them.
  const double wanted = std::clamp(aspect_of(model.positions), 0.6, 2.0);
  const double side = std::min<double>(height, width / (1 + wanted));
  const auto left = static_cast<std::uint32_t>(side), right = static_cast<std::uint32_t>(wanted * side);
  const std::uint32_t gap = (width - left - right) / 3;
  canvas.draw(round.shape(towards_model(mesh, model, component)), {gap, 0, left, height});
  canvas.draw(model, {2 * gap + left, 0, right, height});
  return canvas.picture();
}

} // namespace orbis::texture
