// One chart without a cut, or six: whichever shows the surface in fewer texels.
#include <algorithm>
#include <array>
#include <optional>

#include "core/error.h"
#include "core/texture/cut.h"
#include "core/texture/disk_chart.h"
#include "core/texture/flat_charts.h"
#include "core/texture/flatten.h"
#include "core/texture/plane_energy.h"
#include "core/texture/quality.h"

namespace orbis::texture {
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

std::vector<bool> shown_charts(const CutMesh& mesh) {
  std::vector<bool> out(mesh.charts.size(), false);
  for (const std::uint32_t chart : mesh.chart) out[chart] = true;
  return out;
}

// Charts with what they cost: texels for a unit of surface, at a mean squared stretch (quality.h) of 1. It is 1 for an
// isometry that fills its rectangle.
struct Laid {
  FlatCharts charts;
  double cost = 0;
};

std::vector<Vec3d> positions_of(const FlatCharts& charts, const AtlasComponent& component) {
  std::vector<Vec3d> out(charts.places.size());
  for (std::size_t v = 0; v < charts.mesh.vertices.size(); ++v)
    out[charts.place_of[v]] = interpolated(component.positions, component.triangles, charts.mesh.vertices[v]);
  return out;
}

// The integral over the surface of (1/s1^2 + 1/s2^2) / 2 is that of the map back, over the charts.
double cost_of(const FlatCharts& charts, std::span<const Vec3d> positions) {
  double area = 0, stretch = 0, texels = 0;
  for (std::size_t t = 0; t < charts.triangles.size(); ++t) {
    const FlatCharts::Size& size = charts.sizes[charts.mesh.chart[t]];
    std::array<Vec3d, 3> p;
    std::array<FlatPoint, 3> q;
    for (std::size_t k = 0; k < 3; ++k) {
      const mesh::Index place = charts.triangles[t][k];
      p[k] = positions[place];
      q[k] = {charts.places[place].at.x * size.width, charts.places[place].at.y * size.height};
    }
    const double own = 0.5 * norm(cross(p[1] - p[0], p[2] - p[0])), flat = doubled_area(q[0], q[1], q[2]);
    if (!(own > 0) || !(flat > 0)) continue;
    area += own;
    stretch += own * squared_stretch(p, q, 0.5 * flat);
  }
  for (std::size_t c = 0; c < charts.sizes.size(); ++c)
    if (charts.is_shown[c]) texels += charts.sizes[c].width * charts.sizes[c].height;
  return area > 0 ? stretch * texels / (area * area) : 1;
}

Laid lay(FlatCharts charts, FlatStart start, const AtlasComponent& component, mesh::ThreadPool& pool) {
  const std::vector<Vec3d> positions = positions_of(charts, component);
  flatten(charts, positions, component.delivered, start, component.finish, pool);
  crop(charts, component.delivered);
  charts.is_shown = shown_charts(charts.mesh);
  const double cost = cost_of(charts, positions);
  return {std::move(charts), cost};
}

// Below that a flat chart would have to be drawn out so far that cuts are better: a sphere less a fifth of it.
constexpr double least_openness = 0.2;
// Of one chart, to look no further; small components are many, and worse off in pieces.
constexpr double good_cost = 1.3, good_cost_if_small = 1.7;
constexpr std::size_t small = 200;    // triangles
constexpr double best_cost = 1.02;    // of one chart, to try no other corners
constexpr std::size_t large = 30'000; // triangles: other corners are not worth their time where the first are good
// What lies between several rectangles on a page costs about a tenth; and cuts are worth a fifth.
constexpr double cost_of_packing = 1.1, worth_a_cut = 1.2;
constexpr std::size_t never_cut = 2; // triangles

// How many sets of corners are tried: layouts of large components take long, and differ less.
std::size_t attempts_for(std::size_t triangles) {
  return triangles <= small ? 3 : triangles <= 3'000 ? 5 : triangles <= large ? 3 : 2;
}

std::optional<Laid> lay_as_disk(const AtlasComponent& component, mesh::ThreadPool& pool) {
  const std::optional<Disk> disk = as_disk(component);
  if (!disk || disk->openness < least_openness) return std::nullopt;
  std::vector<Corners> sets{{0, 1, 2, 3}};
  if (disk->outline.size() > 3) sets = corners_of(*disk, component, attempts_for(component.delivered));
  const double enough = component.delivered <= large ? best_cost : good_cost;
  std::optional<Laid> best;
  for (const Corners& corners : sets) {
    if (best && best->cost <= enough) break;
    try {
      std::optional<FlatCharts> charts = cut_to_disk(component, *disk, corners);
      if (!charts) continue;
      Laid laid = lay(std::move(*charts), FlatStart::outlines, component, pool);
      if (!best || laid.cost < best->cost) best = std::move(laid);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::not_certified) throw; // else other corners, or cuts, give it more room
    }
  }
  return best;
}

} // namespace

FlatCharts lay_flat(const AtlasComponent& component, ChartKinds kinds, Progress& progress, mesh::ThreadPool& pool) {
  std::optional<Laid> disk;
  if (kinds == ChartKinds::all) disk = lay_as_disk(component, pool);
  const double good = component.delivered <= small ? good_cost_if_small : good_cost;
  if (disk && (disk->cost <= good || component.delivered <= never_cut)) return std::move(disk->charts);
  Laid faces = lay(cut(component, progress), FlatStart::places, component, pool);
  return std::move(disk && worth_a_cut * cost_of_packing * faces.cost > disk->cost ? disk->charts : faces.charts);
}

} // namespace orbis::texture
