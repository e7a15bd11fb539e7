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

namespace {

// The triangle that holds the place, looked for from `from` on, or where rounding leaves none the one that comes
// closest to it.
std::uint32_t holder(std::span<const AtlasTriangle> triangles, std::uint32_t from, const Uv& uv,
                     std::array<double, 3>& weights) {
  std::uint32_t best = from;
  double inside = -std::numeric_limits<double>::infinity();
  const auto count = static_cast<std::uint32_t>(triangles.size());
  for (std::uint32_t i = 0, t = from; i < count && inside < 0; ++i, t = t + 1 == count ? 0 : t + 1) {
    const std::array<double, 3> w = triangles[t].weights(uv);
    const double least = std::min({w[0], w[1], w[2]});
    if (!(least > inside)) continue;
    inside = least;
    best = t;
    weights = w;
  }
  return best;
}

} // namespace

void Draft::collect(std::span<const std::uint32_t> triangles, std::vector<Held>& out) const {
  out.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t w : of_[triangles[i]]) out.push_back({w, i});
}

double Draft::energy(std::span<Held> held, std::span<const mesh::Triangle> triangles) {
  in_atlas_.clear();
  for (const mesh::Triangle& t : triangles) in_atlas_.push_back(in_atlas(t));
  double sum = 0;
  for (Held& h : held) {
    const Witness& witness = witnesses_[h.witness];
    std::array<double, 3> w{};
    h.triangle = holder(in_atlas_, h.triangle, witness.uv, w);
    const mesh::Triangle& t = triangles[h.triangle];
    sum += witness.deviation(positions[t[0]] * w[0] + positions[t[1]] * w[1] + positions[t[2]] * w[2]);
  }
  return sum;
}

void Draft::hand_over(std::span<const Held> held, std::span<const std::uint32_t> triangles) {
  for (const std::uint32_t t : triangles) of_[t].clear();
  for (const Held& h : held) of_[triangles[h.triangle]].push_back(h.witness);
}

} // namespace orbis::lod
