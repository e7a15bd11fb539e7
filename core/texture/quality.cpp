#include "core/texture/quality.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/texture/density.h"
#include "core/texture/page_raster.h"

namespace orbis::texture {
namespace {

std::vector<Vec3d> positions_of(const CutMesh& mesh, const mesh::TriangleMesh& surface) {
  std::vector<Vec3d> out;
  out.reserve(mesh.vertices.size());
  for (const CutVertex& v : mesh.vertices) out.push_back(interpolated(surface.positions, surface.triangles, v));
  return out;
}

// Edges of the surface, by the points at their ends, that two charts see: half of their length for each.
double seam_length(const CutMesh& mesh, std::span<const Vec3d> positions) {
  struct Side {
    std::uint32_t low, high, chart;
    double length;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const mesh::Index a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      const auto [low, high] = std::minmax(mesh.vertices[a].point, mesh.vertices[b].point);
      sides.push_back({low, high, mesh.chart[t], norm(positions[a] - positions[b])});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  double length = 0;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low == b.low && a.high == b.high && a.chart != b.chart) length += a.length;
  }
  return length;
}

} // namespace

AtlasQuality measure_atlas(const CutMesh& mesh, const mesh::TriangleMesh& surface) {
  const std::vector<Vec3d> positions = positions_of(mesh, surface);
  std::vector<Density> densities;
  std::vector<double> area_of_component;
  double area = 0, texels = 0, stretch = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<RasterPoint, 3> q = in_page(mesh, t);
    std::array<Vec3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = positions[mesh.triangles[t][k]];
    const double a = 0.5 * norm(cross(p[1] - p[0], p[2] - p[0]));
    const double n = 0.5 * std::abs((q[1].x - q[0].x) * (q[2].y - q[0].y) - (q[2].x - q[0].x) * (q[1].y - q[0].y));
    if (!(a > 0) || !(n > 0)) continue;
    const std::uint32_t component = mesh.charts[mesh.chart[t]].component;
    if (component >= area_of_component.size()) area_of_component.resize(component + 1);
    area_of_component[component] += a;
    area += a;
    texels += n;
    stretch += a * squared_stretch(p, q, n);
    densities.push_back({n / a, a});
  }
  AtlasQuality out;
  if (densities.empty()) return out;
  sort_by_density(densities);
  out.texels_per_area = texels / area;
  out.density_min = densities.front().texels_per_area / out.texels_per_area;
  out.density_p1 = percentile(densities, area, 0.01) / out.texels_per_area;
  out.density_median = percentile(densities, area, 0.5) / out.texels_per_area;
  out.l2_stretch = std::sqrt(stretch / area * out.texels_per_area);
  double roots = 0;
  for (const double a : area_of_component) roots += std::sqrt(a);
  out.seam_length = seam_length(mesh, positions) / roots;
  return out;
}

} // namespace orbis::texture
