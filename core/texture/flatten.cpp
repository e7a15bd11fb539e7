#include "core/texture/flatten.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/texture/coarse_warp.h"
#include "core/texture/density.h"
#include "core/texture/harmonic.h"
#include "core/texture/plane_energy.h"
#include "core/texture/plane_newton.h"
#include "core/texture/untangle.h"

namespace orbis::texture {
namespace {

constexpr int most_cycles = 6;
constexpr double worthwhile = 0.01; // of the energy, to go on for
constexpr int first_sweeps = 3, sweeps_a_cycle = 6, last_sweeps = 4;
// Where this part of the surface gets less than this part of the median texels, areas are weighed more and more.
constexpr double sparse_part = 0.01, sparse_density = 0.27;
constexpr std::array<int, 4> heavier_exponents{4, 8, 12, 16}; // the first one to the end, which sweeps may not reach
constexpr std::size_t most_to_finish = 3'000; // triangles: what sweeps leave of larger charts' energy is not worth it
constexpr int heavier_sweeps_a_cycle = 12;
constexpr double least_area_evened = 1e-3;      // of a triangle, in units of its chart's mean
constexpr std::size_t most_for_newton = 20'000; // triangles
constexpr double worthwhile_evenness = 1.03;    // times the sparsest density, to go on for
constexpr double weight_of_hole = 1e-3;         // of a triangle that only closes one
constexpr double least_area = 1e-6;             // of a triangle, in units of the mean
constexpr std::uint32_t most_cells = 32;
constexpr double triangles_a_cell = 8;

// One chart as a mesh of its own.
struct ChartMesh {
  PlaneMesh mesh;
  std::vector<std::uint32_t> places; // point -> place
  std::vector<double> areas;         // of the triangles on the surface; 0 of those that only close holes
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
    r.closes_hole = charts.mesh.parent[t] >= delivered;
    if (r.closes_hole) r.area *= weight_of_hole;
    chart.areas.push_back(r.closes_hole ? 0
                                        : 0.5 * norm(cross(positions[b] - positions[a], positions[c] - positions[a])));
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
double cycle(PlaneMesh& mesh, double part, int sweeps) {
  const std::vector<FlatPoint> before = mesh.points;
  const double energy = energy_of(mesh);
  to_unit_square(mesh);
  const CoarseWarp coarse(mesh, cells_for(mesh.triangles.size()));
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const FlatPoint to = coarse(mesh.points[v]), &from = before[v];
    mesh.points[v] = {from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)};
  }
  if (untangle(mesh)) {
    settle_in_rectangle(mesh, sweeps);
    if (const double now = energy_of(mesh); now < energy) return (energy - now) / energy;
  }
  mesh.points = before;
  return 0;
}

void lower(PlaneMesh& mesh, int sweeps) {
  double part = 1;
  for (int i = 0; i < most_cycles && cells_for(mesh.triangles.size()) > 1; ++i) {
    const double gain = cycle(mesh, part, sweeps);
    if (gain > 0 && gain < worthwhile && part == 1) break;
    part = gain > 0 ? std::min(1.0, 2 * part) : part / 3;
  }
  settle_in_rectangle(mesh, last_sweeps);
}

// From the square of the start to the rectangle of the surface's own size. Returns false where a triangle
// cannot be laid out.
bool flatten_chart(PlaneMesh& mesh, FlatStart start) {
  if (start == FlatStart::outlines && !lay_harmonically(mesh)) return false;
  double area = 0;
  for (const PlaneReference& r : mesh.references) area += r.area;
  for (FlatPoint& p : mesh.points) p = {std::sqrt(area) * p.x, std::sqrt(area) * p.y};
  // Points within the tolerance of a border were moved onto it.
  if (!untangle(mesh)) return false;
  settle_in_rectangle(mesh, first_sweeps);
  lower(mesh, sweeps_a_cycle);
  return true;
}

// How the texels are spread over all charts.
struct Spread {
  double sparsest;                 // the density that sparse_part of the surface does not reach, over the median
  std::vector<std::size_t> sparse; // the charts that hold what gets too few
};

Density density_of(const ChartMesh& chart, std::size_t t) {
  const auto& [a, b, c] = chart.mesh.triangles[t];
  const double area = chart.areas[t];
  return {doubled_area(chart.mesh.points[a], chart.mesh.points[b], chart.mesh.points[c]) / (2 * area), area};
}

Spread spread_over(std::span<const ChartMesh> charts) {
  std::vector<Density> densities;
  double total = 0;
  for (const ChartMesh& chart : charts)
    for (std::size_t t = 0; t < chart.areas.size(); ++t) {
      if (!(chart.areas[t] > 0)) continue;
      densities.push_back(density_of(chart, t));
      total += densities.back().area;
    }
  sort_by_density(densities);
  const double median = percentile(densities, total, 0.5);
  Spread out{densities.empty() ? 1 : percentile(densities, total, sparse_part) / median, {}};
  for (std::size_t c = 0; c < charts.size(); ++c) {
    double sparse = 0;
    for (std::size_t t = 0; t < charts[c].areas.size(); ++t)
      if (charts[c].areas[t] > 0 && density_of(charts[c], t).texels_per_area < sparse_density * median)
        sparse += charts[c].areas[t];
    if (sparse > sparse_part * total / static_cast<double>(charts.size())) out.sparse.push_back(c);
  }
  return out;
}

// The areas of slivers as they are, not rounded off; but none below a part of their mean: triangles that are next to
// nothing would be crushed between the others.
void take_own_areas(ChartMesh& chart) {
  double total = 0;
  for (const double area : chart.areas) total += area;
  const double least = least_area_evened * total / static_cast<double>(chart.areas.size());
  for (std::size_t t = 0; t < chart.areas.size(); ++t) {
    PlaneReference& r = chart.mesh.references[t];
    if (!r.closes_hole) r.area = std::max(chart.areas[t], least);
  }
}

void finish_small_charts(std::vector<ChartMesh>& charts, mesh::ThreadPool& pool) {
  pool.for_blocks(charts.size(), 1, [&](std::size_t c, std::size_t) {
    if (charts[c].mesh.triangles.size() <= most_to_finish) lower_by_newton(charts[c].mesh);
  });
}

// Weighs areas more and more in the charts that get too few texels, until they get enough or it helps no more.
void even_out(std::vector<ChartMesh>& charts, mesh::ThreadPool& pool) {
  Spread spread = spread_over(charts);
  for (const int exponent : heavier_exponents) {
    if (spread.sparsest >= sparse_density) return;
    std::vector<PlaneMesh> before;
    before.reserve(spread.sparse.size());
    for (const std::size_t c : spread.sparse) before.push_back(charts[c].mesh);
    pool.for_blocks(spread.sparse.size(), 1, [&](std::size_t i, std::size_t) {
      ChartMesh& chart = charts[spread.sparse[i]];
      chart.mesh.exponent = exponent;
      take_own_areas(chart);
      if (chart.mesh.triangles.size() <= most_for_newton)
        lower_by_newton(chart.mesh);
      else
        lower(chart.mesh, heavier_sweeps_a_cycle);
    });
    Spread now = spread_over(charts);
    if (now.sparsest < spread.sparsest)
      for (std::size_t i = 0; i < before.size(); ++i) charts[spread.sparse[i]].mesh = std::move(before[i]);
    if (exponent > heavier_exponents.front() && now.sparsest < worthwhile_evenness * spread.sparsest) return;
    spread = std::move(now);
  }
}

} // namespace

void flatten(FlatCharts& charts, std::span<const Vec3d> positions, std::size_t delivered, FlatStart start,
             Finish finish, mesh::ThreadPool& pool) {
  std::vector<ChartMesh> meshes = split(charts, positions, delivered);
  std::vector<std::uint8_t> is_flat(meshes.size()); // no exception may leave a pool's loop
  pool.for_blocks(meshes.size(), 1,
                  [&](std::size_t c, std::size_t) { is_flat[c] = flatten_chart(meshes[c].mesh, start) ? 1 : 0; });
  if (std::ranges::find(is_flat, 0) != is_flat.end())
    throw Error(ErrorCode::not_certified, "a triangle at a border of the cube's faces has no room in its chart");
  if (finish == Finish::newton) {
    finish_small_charts(meshes, pool);
    even_out(meshes, pool);
  }
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
