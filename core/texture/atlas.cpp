#include "core/texture/atlas.h"

#include "core/error.h"
#include "core/texture/cut.h"
#include "core/texture/flat_charts.h"
#include "core/texture/flatten.h"
#include "core/texture/place.h"

namespace orbis::texture {

std::array<double, 3> weights_on(std::uint32_t triangle, std::span<const mesh::Triangle> triangles,
                                 const CutVertex& v) {
  if (v.triangle == triangle) return v.barycentric;
  std::array<double, 3> out{};
  const mesh::Triangle &here = triangles[triangle], &there = triangles[v.triangle];
  for (std::size_t j = 0; j < 3; ++j) {
    if (v.barycentric[j] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (here[i] == there[j]) out[i] = v.barycentric[j];
    }
  }
  return out;
}

namespace {

std::vector<bool> shown_charts(const FlatCharts& charts, std::size_t delivered) {
  std::vector<bool> out(charts.mesh.charts.size(), false);
  for (std::size_t t = 0; t < charts.mesh.triangles.size(); ++t)
    if (charts.mesh.parent[t] < delivered) out[charts.mesh.chart[t]] = true;
  return out;
}

} // namespace

double utilisation(const CutMesh& mesh) {
  double used = 0, all = 0;
  for (const Chart& c : mesh.charts) used += static_cast<double>(c.width) * c.height;
  for (const Page& p : mesh.pages) all += static_cast<double>(p.width) * p.height;
  return all > 0 ? used / all : 0;
}

FlatCharts lay_flat(const AtlasComponent& component, Progress& progress, mesh::ThreadPool& pool) {
  FlatCharts charts = cut(component, progress);
  charts.is_shown = shown_charts(charts, component.delivered);
  std::vector<Vec3d> positions(charts.places.size());
  for (std::size_t v = 0; v < charts.mesh.vertices.size(); ++v)
    positions[charts.place_of[v]] = interpolated(component.positions, component.triangles, charts.mesh.vertices[v]);
  flatten(charts, positions, component.delivered, pool);
  return charts;
}

CutMesh make_atlas(const AtlasComponent& component, std::uint32_t texture_size, Progress& progress) {
  mesh::ThreadPool here(1);
  const FlatCharts charts = lay_flat(component, progress, here);
  Placed placed = place(std::span(&component, 1), std::span(&charts, 1), {.width = texture_size});
  if (!placed.folded.empty())
    throw Error(ErrorCode::not_certified, "a triangle is too small for the numbers of the atlas");
  progress.report(Stage::atlas, 1, 1);
  return std::move(placed.mesh);
}

} // namespace orbis::texture
