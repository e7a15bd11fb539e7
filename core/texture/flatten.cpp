#include "core/texture/flatten.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/texture/coarse_warp.h"
#include "core/texture/plane_energy.h"
#include "core/texture/untangle.h"

namespace orbis::texture {
namespace {

constexpr int most_cycles = 6;
constexpr double worthwhile = 0.01; // of the energy, to go on for
constexpr int first_sweeps = 3, sweeps_a_cycle = 6, last_sweeps = 4;
constexpr double weight_of_hole = 1e-3; // of a triangle that only closes one
constexpr double least_area = 1e-6;     // of a triangle, in units of the mean
constexpr std::uint32_t most_cells = 32;
constexpr double triangles_a_cell = 8;

// One chart as a mesh of its own.
struct ChartMesh {
  PlaneMesh mesh;
  std::vector<std::uint32_t> places; // point -> place
};

std::vector<ChartMesh> split(const FlatCharts& charts, std::span<const Vec3d> positions, std::size_t delivered) {
  std::vector<ChartMesh> out(charts.mesh.charts.size());
  std::vector<mesh::Index> number(charts.places.size());
  for (std::uint32_t p = 0; p < charts.places.size(); ++p) {
    const FlatPlace& place = charts.places[p];
    ChartMesh& chart = out[place.chart];
    number[p] = static_cast<mesh::Index>(chart.places.size());
    chart.places.push_back(p);
    chart.mesh.points.push_back(place.at);
    chart.mesh.fixed_x.push_back(place.fixed_x);
    chart.mesh.fixed_y.push_back(place.fixed_y);
  }
  double total = 0;
  for (std::size_t t = 0; t < charts.triangles.size(); ++t) {
    const auto& [a, b, c] = charts.triangles[t];
    ChartMesh& chart = out[charts.mesh.chart[t]];
    chart.mesh.triangles.push_back({number[a], number[b], number[c]});
    PlaneReference r = plane_reference(positions[a], positions[b], positions[c]);
    if (charts.mesh.parent[t] >= delivered) r.area *= weight_of_hole;
    total += r.area;
    chart.mesh.references.push_back(r);
  }
  const double mean = total / static_cast<double>(charts.triangles.size());
  for (ChartMesh& chart : out)
    for (PlaneReference& r : chart.mesh.references) r.area = total > 0 ? std::max(r.area, least_area * mean) : 1;
  return out;
}

std::uint32_t cells_for(std::size_t triangles) {
  const double cells = std::sqrt(static_cast<double>(triangles) / triangles_a_cell);
  return std::min(std::bit_floor(static_cast<std::uint32_t>(std::max(cells, 1.0))), most_cells);
}

FlatCharts::Size size_of(const PlaneMesh& mesh) {
  FlatCharts::Size size{0, 0};
  for (const FlatPoint& p : mesh.points) size = {std::max(size.width, p.x), std::max(size.height, p.y)};
  return size;
}

void to_unit_square(PlaneMesh& mesh) {
  const FlatCharts::Size size = size_of(mesh);
  for (FlatPoint& p : mesh.points) p = {p.x / size.width, p.y / size.height};
}

void settle_in_rectangle(PlaneMesh& mesh, int sweeps) {
  stretch_to_best(mesh);
  relax(mesh, sweeps);
  stretch_to_best(mesh);
}

// One step for the low frequencies and one for the high ones: `part` of the way to where the warp says. Returns the
// part of the energy that was gained; 0 where that folds triangles beyond mending or does not pay: the mesh is then as
// before.
double cycle(PlaneMesh& mesh, double part) {
  const std::vector<FlatPoint> before = mesh.points;
  const double energy = energy_of(mesh);
  to_unit_square(mesh);
  const CoarseWarp coarse(mesh, cells_for(mesh.triangles.size()));
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const FlatPoint to = coarse(mesh.points[v]), &from = before[v];
    mesh.points[v] = {from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)};
  }
  if (untangle(mesh)) {
    settle_in_rectangle(mesh, sweeps_a_cycle);
    if (const double now = energy_of(mesh); now < energy) return (energy - now) / energy;
  }
  mesh.points = before;
  return 0;
}

// From the square of the central projection to the rectangle of the surface's own size. Returns false where a triangle
// cannot be laid out.
bool flatten_chart(PlaneMesh& mesh) {
  double area = 0;
  for (const PlaneReference& r : mesh.references) area += r.area;
  for (FlatPoint& p : mesh.points) p = {std::sqrt(area) * p.x, std::sqrt(area) * p.y};
  // Points within the tolerance of a border were moved onto it.
  if (!untangle(mesh)) return false;
  settle_in_rectangle(mesh, first_sweeps);
  double part = 1;
  for (int i = 0; i < most_cycles && cells_for(mesh.triangles.size()) > 1; ++i) {
    const double gain = cycle(mesh, part);
    if (gain > 0 && gain < worthwhile && part == 1) break;
    part = gain > 0 ? std::min(1.0, 2 * part) : part / 3;
  }
  settle_in_rectangle(mesh, last_sweeps);
  return true;
}

} // namespace

void flatten(FlatCharts& charts, std::span<const Vec3d> positions, std::size_t delivered, mesh::ThreadPool& pool) {
  std::vector<ChartMesh> meshes = split(charts, positions, delivered);
  std::vector<std::uint8_t> is_flat(meshes.size()); // no exception may leave a pool's loop
  pool.for_blocks(meshes.size(), 1,
                  [&](std::size_t c, std::size_t) { is_flat[c] = flatten_chart(meshes[c].mesh) ? 1 : 0; });
  if (std::ranges::find(is_flat, 0) != is_flat.end())
    throw Error(ErrorCode::not_certified, "a triangle at a border of the cube's faces has no room in its chart");
  charts.sizes.clear();
  for (const ChartMesh& chart : meshes) {
    const FlatCharts::Size size = size_of(chart.mesh);
    charts.sizes.push_back(size);
    for (std::size_t i = 0; i < chart.places.size(); ++i) {
      FlatPlace& place = charts.places[chart.places[i]];
      const FlatPoint& p = chart.mesh.points[i];
      // Places on a side are there exactly already.
      if (!place.fixed_x) place.at.x = p.x / size.width;
      if (!place.fixed_y) place.at.y = p.y / size.height;
    }
  }
}

} // namespace orbis::texture
