#include "core/lod/extract.h"

#include <algorithm>

namespace orbis::lod {

Level extract(const FullSurface& full, const WedgeMesh& mesh) {
  Level level;
  texture::CutMesh& out = level.mesh;
  out.charts = full.cut().charts;
  out.pages = full.cut().pages;
  out.gutter = full.cut().gutter;
  std::vector<std::uint32_t> number(mesh.wedges.size(), none), point_number(mesh.points.size(), none);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.is_alive[t]) continue;
    mesh::Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t w = mesh.triangles[t][k];
      const Wedge& wedge = mesh.wedges[w];
      const Point& point = mesh.points[wedge.point];
      std::uint32_t& new_point = point_number[wedge.point];
      if (new_point == none) new_point = static_cast<std::uint32_t>(out.points++);
      if (number[w] == none) {
        number[w] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back({wedge.source, wedge.weights, point.sphere, wedge.uv, new_point});
        level.positions.push_back(full.in_model(point.position));
        level.near.push_back(wedge.near);
      }
      triangle[k] = number[w];
    }
    out.triangles.push_back(triangle);
    level.regions.push_back(mesh.wedges[mesh.triangles[t][0]].region);
    out.parent.push_back(mesh.parent[t]);
    out.chart.push_back(full.cut().chart[t]);
  }
  return level;
}

std::vector<std::uint32_t> first_of_regions(const FullSurface& full, const Level& level) {
  std::vector<std::uint32_t> first(1 + *std::max_element(full.regions().begin(), full.regions().end()), none);
  for (std::uint32_t t = 0; t < level.regions.size(); ++t)
    if (first[level.regions[t]] == none) first[level.regions[t]] = t;
  return first;
}

} // namespace orbis::lod
