#include "core/lod/draft.h"

#include <algorithm>
#include <limits>

#include "core/lod/extract.h"
#include "core/lod/uv_orientation.h"
#include "core/sphere/orientation.h"

namespace orbis::lod {
namespace {

constexpr std::size_t enough = 48; // witnesses for a triangle of the level, on average

} // namespace

double Witness::deviation(const Vec3d& p) const {
  const Vec3d r = p - position;
  const double off = dot(normal, r);
  return weighing.weight * ((1 - weighing.slip) * off * off + weighing.slip * squared_norm(r));
}

Draft::Draft(const FullSurface& full, Level& level) : full_(full), level_(level), of_(level.mesh.triangles.size()) {
  for (const Vec3f& p : level.positions) positions.push_back(full.in_scale(p));
  const texture::CutMesh& cut = full.cut();
  const ChartMap map(level.mesh, level.regions);
  std::vector<std::uint32_t> near = first_of_regions(full, level);
  const auto step = std::max<std::uint32_t>(
      1, static_cast<std::uint32_t>(cut.triangles.size() / (enough * std::max<std::size_t>(of_.size(), 1))));
  constexpr double third = 1.0 / 3;
  for (std::uint32_t t = 0; t < cut.triangles.size(); t += step) {
    std::uint32_t& from = near[full.regions()[t]];
    if (from == none || !(full.weighing(t).weight > 0)) continue; // the level has lost this component; no area
    const auto& [a, b, c] = cut.triangles[t];
    Witness w{{}, full.position({t, {third, third, third}}), full.normal(t), full.weighing(t)};
    for (const mesh::Index v : {a, b, c}) {
      w.uv[0] += third * cut.vertices[v].uv.x;
      w.uv[1] += third * cut.vertices[v].uv.y;
    }
    const std::optional<Place> place = map.locate(w.uv, from);
    if (!place) continue; // a border's rounding
    from = place->triangle;
    of_[from].push_back(static_cast<std::uint32_t>(witnesses_.size()));
    witnesses_.push_back(w);
  }
}

void Draft::write_positions() {
  for (std::size_t v = 0; v < positions.size(); ++v) level_.positions[v] = full_.in_model(positions[v]);
}

std::array<double, 3> Draft::weights_in(const mesh::Triangle& triangle, const Uv& uv) const {
  const auto& vertices = level_.mesh.vertices;
  const Vec2f &a = vertices[triangle[0]].uv, &b = vertices[triangle[1]].uv, &c = vertices[triangle[2]].uv;
  const double bx = double{b.x} - a.x, by = double{b.y} - a.y, cx = double{c.x} - a.x, cy = double{c.y} - a.y;
  const double x = uv[0] - a.x, y = uv[1] - a.y, area = bx * cy - by * cx;
  const double second = (x * cy - y * cx) / area, third = (bx * y - by * x) / area;
  return {1 - second - third, second, third};
}

Vec3d Draft::area_normal(const mesh::Triangle& t) const {
  return cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
}

int Draft::atlas_orientation(const mesh::Triangle& t) const {
  const auto& v = level_.mesh.vertices;
  return uv_orientation(v[t[0]].uv, v[t[1]].uv, v[t[2]].uv);
}

bool Draft::is_sound(const mesh::Triangle& t, int sign) const {
  const auto& v = level_.mesh.vertices;
  return atlas_orientation(t) == sign && sphere::orientation(v[t[0]].sphere, v[t[1]].sphere, v[t[2]].sphere) == 1;
}

// The triangle that holds the place, or where rounding leaves none the one that comes closest to it.
std::size_t Draft::holder(const Uv& uv, std::span<const mesh::Triangle> triangles,
                          std::array<double, 3>& weights) const {
  std::size_t best = 0;
  double inside = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < triangles.size() && inside < 0; ++i) {
    const std::array<double, 3> w = weights_in(triangles[i], uv);
    const double least = std::min({w[0], w[1], w[2]});
    if (!(least > inside)) continue;
    inside = least;
    best = i;
    weights = w;
  }
  return best;
}

double Draft::energy(std::span<const std::uint32_t> numbers, std::span<const mesh::Triangle> triangles) const {
  double sum = 0;
  for (const std::uint32_t number : numbers) {
    const Witness& witness = witnesses_[number];
    std::array<double, 3> w{};
    const mesh::Triangle& t = triangles[holder(witness.uv, triangles, w)];
    sum += witness.deviation(positions[t[0]] * w[0] + positions[t[1]] * w[1] + positions[t[2]] * w[2]);
  }
  return sum;
}

void Draft::sort_again(std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> numbers;
  std::vector<mesh::Triangle> corners;
  for (const std::uint32_t t : triangles) {
    numbers.insert(numbers.end(), of_[t].begin(), of_[t].end());
    of_[t].clear();
    corners.push_back(level_.mesh.triangles[t]);
  }
  std::array<double, 3> w{};
  for (const std::uint32_t number : numbers)
    of_[triangles[holder(witnesses_[number].uv, corners, w)]].push_back(number);
}

} // namespace orbis::lod
