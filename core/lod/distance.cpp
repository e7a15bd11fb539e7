#include "core/lod/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/lod/samples.h"

namespace orbis::lod {
namespace {

constexpr std::size_t sample_count = 20'000; // in each direction: the mean is then good to one per cent
constexpr std::size_t grain = 512;
// What float coordinates may be off at a border of a chart, in the atlas.
constexpr double rounding = 1.0 / (1 << 19);

std::vector<Vec3d> scaled_positions(const FullSurface& full, const Level& level) {
  std::vector<Vec3d> out;
  out.reserve(level.positions.size());
  for (const Vec3f& p : level.positions) out.push_back(full.in_scale(p));
  return out;
}

struct Sums {
  double sum = 0, largest = 0;
};

template <class Distance> Sums over(mesh::ThreadPool& threads, std::size_t count, const Distance& distance) {
  std::vector<double> largest((count + grain - 1) / grain);
  const double sum = threads.sum_blocks(count, grain, [&](std::size_t begin, std::size_t end) {
    double block = 0, most = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double d = distance(i);
      block += d;
      most = std::max(most, d);
    }
    largest[begin / grain] = most;
    return block;
  });
  return {sum, largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end())};
}

// Mean and largest distance of samples of one surface from another's tree.
Sums measure(mesh::ThreadPool& threads, const TriangleTree& tree, std::span<const Vec3d> points) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Sums sums = over(threads, points.size(),
                   [&](std::size_t i) { return std::sqrt(tree.squared_distance(points[i], infinity)); });
  if (!points.empty()) sums.sum /= static_cast<double>(points.size());
  return sums;
}

// The largest distance of the points from the tree's surface, or `least` where all are nearer than that.
double farthest(mesh::ThreadPool& threads, const TriangleTree& tree, std::span<const Vec3d> points, double least) {
  std::vector<double> of_block((points.size() + grain - 1) / grain, least * least);
  threads.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
    double& most = of_block[begin / grain];
    for (std::size_t i = begin; i < end; ++i) {
      if (!tree.is_within(points[i], most))
        most = std::max(most, tree.squared_distance(points[i], std::numeric_limits<double>::infinity()));
    }
  });
  double most = least * least;
  for (const double block : of_block) most = std::max(most, block);
  return most > least * least ? std::sqrt(most) : least;
}

std::vector<Vec3d> points_on(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles) {
  std::vector<Vec3d> out;
  for (const Sample& s : spread_samples(positions, triangles, sample_count)) out.push_back(s.on(positions, triangles));
  return out;
}

Distances measure_both(mesh::ThreadPool& threads, std::span<const Vec3d> positions,
                       std::span<const mesh::Triangle> triangles, std::span<const Vec3d> full_positions,
                       std::span<const mesh::Triangle> full_triangles, const TriangleTree& full_tree) {
  const Sums to_full = measure(threads, full_tree, points_on(positions, triangles));
  const TriangleTree own(positions, triangles);
  const Sums from_full = measure(threads, own, points_on(full_positions, full_triangles));
  const double of_samples = std::max(to_full.largest, from_full.largest);
  return {to_full.sum, from_full.sum, farthest(threads, own, full_positions, of_samples)};
}

} // namespace

Distances distances_between(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                            std::span<const Vec3d> full_positions, std::span<const mesh::Triangle> full_triangles,
                            mesh::ThreadPool& threads) {
  const TriangleTree full_tree(full_positions, full_triangles);
  return measure_both(threads, positions, triangles, full_positions, full_triangles, full_tree);
}

Ruler::Ruler(const FullSurface& full, mesh::ThreadPool& threads)
    : full_(full), threads_(threads), tree_(full.positions(), full.cut().triangles),
      of_chart_(full.cut().charts.size()) {
  for (std::uint32_t t = 0; t < full.cut().triangles.size(); ++t) of_chart_[full.cut().chart[t]].push_back(t);
}

Distances Ruler::distances(const Level& level) const {
  const std::vector<Vec3d> positions = scaled_positions(full_, level);
  return measure_both(threads_, positions, level.mesh.triangles, full_.positions(), full_.cut().triangles, tree_);
}

// Triangle by triangle: where a walk ends at a hole, or at another material, the chart may go on behind it.
std::optional<Place> Ruler::search(std::uint32_t chart, const Uv& uv) const {
  const auto& vertices = full_.cut().vertices;
  for (const std::uint32_t t : of_chart_[chart]) {
    const auto& [i, j, k] = full_.cut().triangles[t];
    const Vec2f &a = vertices[i].uv, &b = vertices[j].uv, &c = vertices[k].uv;
    const auto turn = [&](const Vec2f& p, const Vec2f& q) {
      return (double{q.x} - p.x) * (uv[1] - p.y) - (uv[0] - p.x) * (double{q.y} - p.y);
    };
    const double ab = turn(a, b), bc = turn(b, c), ca = turn(c, a), whole = ab + bc + ca;
    if (whole == 0 || std::min({ab / whole, bc / whole, ca / whole}) < 0) continue;
    return Place{t, {bc / whole, ca / whole, ab / whole}};
  }
  return std::nullopt;
}

std::optional<Place> Ruler::find(const Level& level, std::uint32_t triangle, const Uv& uv) const {
  const mesh::Triangle& corners = level.mesh.triangles[triangle];
  const auto walk = [&](const Uv& to) {
    std::optional<Place> place;
    for (std::size_t k = 0; k < 3 && !place; ++k) place = full_.chart_map().locate(to, level.near[corners[k]]);
    return place;
  };
  if (std::optional<Place> place = walk(uv)) return place;
  // A border's rounding further in.
  Uv middle{};
  for (const mesh::Index v : corners) {
    middle[0] += level.mesh.vertices[v].uv.x / 3.0;
    middle[1] += level.mesh.vertices[v].uv.y / 3.0;
  }
  const double length = std::hypot(middle[0] - uv[0], middle[1] - uv[1]);
  const double t = length > rounding ? rounding / length : 1;
  const Uv further{uv[0] + t * (middle[0] - uv[0]), uv[1] + t * (middle[1] - uv[1])};
  if (std::optional<Place> place = walk(further)) return place;
  return search(level.mesh.chart[triangle], further);
}

TextureDeviation Ruler::texture_deviation(const Level& level) const {
  const std::vector<Vec3d> positions = scaled_positions(full_, level);
  const std::vector<Sample> samples = spread_samples(positions, level.mesh.triangles, sample_count);
  std::vector<std::uint8_t> is_outside(samples.size());
  const Sums sums = over(threads_, samples.size(), [&](std::size_t i) {
    const Sample& s = samples[i];
    Uv uv{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f& corner = level.mesh.vertices[level.mesh.triangles[s.triangle][k]].uv;
      uv[0] += s.weights[k] * corner.x;
      uv[1] += s.weights[k] * corner.y;
    }
    const std::optional<Place> place = find(level, s.triangle, uv);
    is_outside[i] = place ? 0 : 1;
    return place ? norm(full_.position(*place) - s.on(positions, level.mesh.triangles)) : 0.0;
  });
  const auto outside = static_cast<double>(std::count(is_outside.begin(), is_outside.end(), 1));
  const auto count = static_cast<double>(samples.size());
  return {count > outside ? sums.sum / (count - outside) : 0, sums.largest, count > 0 ? outside / count : 0};
}

} // namespace orbis::lod
