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

std::vector<bool> shown_charts(const CutMesh& mesh) {
  std::vector<bool> out(mesh.charts.size(), false);
  for (const std::uint32_t chart : mesh.chart) out[chart] = true;
  return out;
}

} // namespace

double utilisation(const CutMesh& mesh) {
  double used = 0, all = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec2f &p = mesh.vertices[a].uv, &q = mesh.vertices[b].uv, &r = mesh.vertices[c].uv;
    const Page& page = mesh.pages[mesh.page_of(t)];
    used += 0.5 * std::abs((double{q.x} - p.x) * (double{r.y} - p.y) - (double{q.y} - p.y) * (double{r.x} - p.x)) *
            page.width * page.height;
  }
  for (const Page& p : mesh.pages) all += static_cast<double>(p.width) * p.height;
  return all > 0 ? used / all : 0;
}

namespace {

// What is left of a chart's rectangle without the triangles that only close holes.
struct Part {
  double low_x = 1, high_x = 0, low_y = 1, high_y = 0;

  void add(const FlatPoint& p) {
    low_x = std::min(low_x, p.x);
    high_x = std::max(high_x, p.x);
    low_y = std::min(low_y, p.y);
    high_y = std::max(high_y, p.y);
  }
  [[nodiscard]] double width() const { return high_x - low_x; }
  [[nodiscard]] double height() const { return high_y - low_y; }
  // Room for points that move by some units of the grid, but on the chart's own sides.
  void widen() {
    constexpr double margin = 1.0 / 64;
    const double x = margin * width(), y = margin * height();
    low_x = std::max(low_x - x, 0.0);
    high_x = std::min(high_x + x, 1.0);
    low_y = std::max(low_y - y, 0.0);
    high_y = std::min(high_y + y, 1.0);
  }
};

// Takes the triangles that only close holes away, and the parts of the charts that then show nothing.
void crop(FlatCharts& charts, std::size_t delivered) {
  CutMesh& mesh = charts.mesh;
  std::vector<Part> parts(charts.sizes.size());
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.parent[t] >= delivered) continue;
    for (const mesh::Index p : charts.triangles[t]) parts[mesh.chart[t]].add(charts.places[p].at);
    mesh.triangles[kept] = mesh.triangles[t];
    mesh.parent[kept] = mesh.parent[t];
    mesh.chart[kept] = mesh.chart[t];
    charts.triangles[kept++] = charts.triangles[t];
  }
  if (kept == mesh.triangles.size()) return; // nothing closes a hole here
  mesh.triangles.resize(kept);
  mesh.parent.resize(kept);
  mesh.chart.resize(kept);
  charts.triangles.resize(kept);
  for (std::size_t c = 0; c < parts.size(); ++c) {
    if (!(parts[c].width() > 0 && parts[c].height() > 0)) parts[c] = {0, 1, 0, 1};
    parts[c].widen();
    charts.sizes[c].width *= parts[c].width();
    charts.sizes[c].height *= parts[c].height();
  }
  for (FlatPlace& place : charts.places) {
    const Part& part = parts[place.chart];
    place.at = {std::clamp((place.at.x - part.low_x) / part.width(), 0.0, 1.0),
                std::clamp((place.at.y - part.low_y) / part.height(), 0.0, 1.0)};
  }
}

} // namespace

FlatCharts lay_flat(const AtlasComponent& component, Progress& progress, mesh::ThreadPool& pool) {
  FlatCharts charts = cut(component, progress);
  std::vector<Vec3d> positions(charts.places.size());
  for (std::size_t v = 0; v < charts.mesh.vertices.size(); ++v)
    positions[charts.place_of[v]] = interpolated(component.positions, component.triangles, charts.mesh.vertices[v]);
  flatten(charts, positions, component.delivered, pool);
  crop(charts, component.delivered);
  charts.is_shown = shown_charts(charts.mesh);
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
