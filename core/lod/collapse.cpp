#include "core/lod/collapse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/lod/uv_orientation.h"

namespace orbis::lod {
namespace {

constexpr double least_cosine = 0.2;         // of the angle by which a triangle may turn in one collapse
constexpr double rounding = 1.0 / (1 << 20); // of the atlas: a five-hundredth of a texel at 2048

// Distance of p from the segment (a, b).
double distance_to_segment(const Vec2f& p, const Vec2f& a, const Vec2f& b) {
  const double dx = double{b.x} - a.x, dy = double{b.y} - a.y, px = double{p.x} - a.x, py = double{p.y} - a.y;
  const double length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0;
  return std::hypot(px - t * dx, py - t * dy);
}

EdgeSides reversed(const EdgeSides& sides) { return {sides.at_b, sides.at_a, sides.triangle}; }

} // namespace

Collapser::Collapser(const FullSurface& full, WedgeMesh& mesh) : full_(full), mesh_(mesh) {
  const auto& regions = full.regions();
  std::vector<double> area(regions.empty() ? 0 : *std::max_element(regions.begin(), regions.end()) + 1);
  for (std::size_t t = 0; t < regions.size(); ++t) {
    const auto& [a, b, c] = full.cut().triangles[t];
    const auto& v = full.cut().vertices;
    area[regions[t]] += (double{v[b].uv.x} - v[a].uv.x) * (double{v[c].uv.y} - v[a].uv.y) -
                        (double{v[c].uv.x} - v[a].uv.x) * (double{v[b].uv.y} - v[a].uv.y);
  }
  for (const double a : area) sign_.push_back(a < 0 ? -1 : 1);
}

Uv Collapser::scaled(const Vec2f& uv) const { return {full_.uv_scale() * uv.x, full_.uv_scale() * uv.y}; }

std::optional<Collapse> Collapser::propose(std::uint32_t a, std::uint32_t b, std::uint32_t attempt) const {
  const std::optional<EdgeSides> sides = mesh_.sides_of(a, b);
  if (!sides) return std::nullopt;
  const PointKind at_a = mesh_.points[a].kind, at_b = mesh_.points[b].kind;
  const bool a_is_free = at_a == PointKind::interior, b_is_free = at_b == PointKind::interior;
  if (a_is_free && b_is_free) {
    if (attempt == 0) return move_both(a, b, *sides);
    --attempt;
  }
  // An edge from seam to seam through a chart stays: to contract it would pinch the chart.
  if (!a_is_free && !b_is_free && !sides->is_seam()) return std::nullopt;
  const auto may_go = [&](PointKind kind, bool other_is_free) {
    return kind == PointKind::interior || (kind == PointKind::seam && !other_is_free);
  };
  std::optional<Collapse> first, second;
  if (may_go(at_a, b_is_free)) first = keep(b, a, *sides);
  if (may_go(at_b, a_is_free)) second = keep(a, b, reversed(*sides));
  if (!first || (second && second->cost < first->cost)) std::swap(first, second);
  return attempt == 0 ? first : attempt == 1 ? second : std::nullopt;
}

std::optional<Collapse> Collapser::move_both(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const {
  DeviationQuadric q = mesh_.quadrics[sides.at_a[0]];
  q += mesh_.quadrics[sides.at_b[0]];
  const Uv u = scaled(mesh_.wedges[sides.at_a[0]].uv), v = scaled(mesh_.wedges[sides.at_b[0]].uv);
  const Uv middle{0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1])};
  const std::optional<Uv> best = q.best_place(middle);
  if (!best) return std::nullopt;
  // Far from both, the maps that were added up say nothing.
  if (std::hypot((*best)[0] - middle[0], (*best)[1] - middle[1]) > std::hypot(u[0] - v[0], u[1] - v[1]))
    return std::nullopt;
  const PositionQuadric at_best = q.at(*best);
  const std::optional<Vec3d> p = at_best.minimiser();
  if (!p) return std::nullopt;
  return Collapse{a, b, sides, *p, best, std::max(at_best.value(*p), 0.0)};
}

std::optional<Collapse> Collapser::keep(std::uint32_t kept, std::uint32_t removed, const EdgeSides& sides) const {
  PositionQuadric sum;
  const auto add = [&](std::uint32_t quadric, std::uint32_t place) {
    sum += mesh_.quadrics[quadric].at(scaled(mesh_.wedges[place].uv));
  };
  add(sides.at_a[0], sides.at_b[0]);
  if (sides.at_a[1] != sides.at_a[0]) add(sides.at_a[1], sides.at_b[1]);
  std::array<std::uint32_t, 16> seen{}; // a point where more regions meet is kept exact by those that fit
  std::size_t count = 0;
  mesh_.for_each_corner(kept, [&](std::uint32_t corner) {
    const std::uint32_t wedge = mesh_.triangles[corner / 3][corner % 3];
    if (std::find(seen.begin(), seen.begin() + count, wedge) != seen.begin() + count || count == seen.size()) return;
    seen[count++] = wedge;
    add(wedge, wedge);
  });
  const Vec3d own = mesh_.points[kept].position;
  const Vec3d p = mesh_.points[kept].is_joint ? own : sum.minimiser().value_or(own);
  return Collapse{removed, kept, sides, p, std::nullopt, std::max(sum.value(p), 0.0)};
}

std::optional<Collapser::Goal> Collapser::goal_of(const Collapse& collapse) const {
  const Wedge& wedge = mesh_.wedges[collapse.sides.at_b[0]];
  Goal goal{collapse.position, mesh_.points[collapse.kept].sphere, wedge.uv, {}, collapse.moved_to.has_value()};
  if (!goal.has_moved) return goal;
  goal.uv = {static_cast<float>((*collapse.moved_to)[0] / full_.uv_scale()),
             static_cast<float>((*collapse.moved_to)[1] / full_.uv_scale())};
  const std::optional<Place> place = full_.chart_map().locate({goal.uv.x, goal.uv.y}, wedge.near);
  if (!place) return std::nullopt;
  goal.place = *place;
  goal.sphere = full_.sphere_point(*place);
  return goal;
}

bool Collapser::keeps_outline(const Collapse& collapse, const Constraints& constraints, double& drift) const {
  // The seam's other neighbour, and its wedges on the two sides.
  std::vector<std::uint32_t> ring;
  mesh_.neighbours_of(collapse.removed, ring);
  for (const std::uint32_t q : ring) {
    if (q == collapse.kept) continue;
    const std::optional<EdgeSides> sides = mesh_.sides_of(collapse.removed, q);
    if (!sides || !sides->is_seam()) continue;
    double distance = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      // The same wedge of the removed point looks at the kept point.
      const std::size_t same = sides->at_a[side] == collapse.sides.at_a[0] ? 0 : 1;
      if (sides->at_a[side] != collapse.sides.at_a[same]) return false;
      const auto uv = [&](std::uint32_t w) { return mesh_.wedges[w].uv; };
      distance = std::max(
          distance, distance_to_segment(uv(sides->at_a[side]), uv(sides->at_b[side]), uv(collapse.sides.at_b[same])));
    }
    if (distance <= rounding) return true;
    drift = distance +
            std::max({mesh_.points[collapse.removed].drift, mesh_.points[collapse.kept].drift, mesh_.points[q].drift});
    return drift <= (sides->is_border() ? constraints.border_tolerance : constraints.outline_tolerance);
  }
  return false;
}

bool Collapser::keeps_triangles(const Collapse& collapse, const Goal& goal, const Constraints& constraints) const {
  const auto is_kept_sound = [&](std::uint32_t corner, bool is_at_kept) {
    const std::uint32_t t = corner / 3;
    const mesh::Triangle& wedges = mesh_.triangles[t];
    if (t == collapse.sides.triangle[0] || t == collapse.sides.triangle[1]) return true;
    const std::uint32_t own = wedges[corner % 3];
    const std::uint32_t next = wedges[(corner % 3 + 1) % 3], last = wedges[(corner % 3 + 2) % 3];
    const Point &here = mesh_.points[mesh_.wedges[own].point], &p = mesh_.points[mesh_.wedges[next].point],
                &q = mesh_.points[mesh_.wedges[last].point];
    if (goal.has_moved || !is_at_kept) {
      const Vec2f uv = goal.has_moved                  ? goal.uv
                       : own == collapse.sides.at_a[0] ? mesh_.wedges[collapse.sides.at_b[0]].uv
                                                       : mesh_.wedges[collapse.sides.at_b[1]].uv;
      if (uv_orientation(uv, mesh_.wedges[next].uv, mesh_.wedges[last].uv) != sign_[mesh_.wedges[own].region])
        return false;
      if (sphere::orientation(goal.sphere, p.sphere, q.sphere) != 1) return false;
    }
    if (!constraints.keeps_normals) return true;
    const Vec3d edge = q.position - p.position;
    const Vec3d before = cross(edge, here.position - p.position), after = cross(edge, goal.position - p.position);
    return dot(before, after) >= least_cosine * std::sqrt(squared_norm(before) * squared_norm(after));
  };
  bool is_sound = true;
  mesh_.for_each_corner(collapse.removed, [&](std::uint32_t c) { is_sound = is_sound && is_kept_sound(c, false); });
  if (!is_sound) return false;
  mesh_.for_each_corner(collapse.kept, [&](std::uint32_t c) { is_sound = is_sound && is_kept_sound(c, true); });
  return is_sound;
}

bool Collapser::perform(const Collapse& collapse, const Constraints& constraints) {
  double drift = 0;
  if (mesh_.points[collapse.removed].kind == PointKind::seam && !keeps_outline(collapse, constraints, drift))
    return false;
  if (!mesh_.link_condition(collapse.removed, collapse.kept, collapse.sides)) return false;
  const std::optional<Goal> goal = goal_of(collapse);
  if (!goal || !keeps_triangles(collapse, *goal, constraints)) return false;

  mesh_.contract(collapse.removed, collapse.kept, collapse.sides);
  Point& kept = mesh_.points[collapse.kept];
  kept.position = goal->position;
  kept.drift = std::max(kept.drift, static_cast<float>(drift));
  ++kept.version;
  if (goal->has_moved) {
    kept.sphere = goal->sphere;
    Wedge& wedge = mesh_.wedges[collapse.sides.at_b[0]];
    wedge.uv = goal->uv;
    wedge.source = full_.cut().parent[goal->place.triangle];
    wedge.weights = full_.weights_on_parent(goal->place);
    wedge.near = goal->place.triangle;
  }
  return true;
}

} // namespace orbis::lod
