#include "core/lod/collapse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/lod/rim_place.h"
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

bool Collapser::may_go(std::uint32_t a, std::uint32_t b, const EdgeSides& sides, Seams seams) const {
  const Point &removed = mesh_.points[a], &kept = mesh_.points[b];
  if (removed.is_joint && constraints.keeps_joints) {
    // Along the rim, from joint to joint; between two of them a point of one rim alone lies on a straight edge, which
    // stays as long as it does.
    if (!kept.is_joint || !sides.is_border()) return false;
    if (removed.joint != none && (kept.joint == none || !mesh_.is_between_joints(a))) return false;
  }
  if (seams == Seams::broken || removed.kind == PointKind::interior) return true;
  return removed.kind == PointKind::seam && kept.kind != PointKind::interior;
}

std::optional<Collapse> Collapser::propose(std::uint32_t a, std::uint32_t b, Seams seams, std::uint32_t attempt) const {
  const std::optional<EdgeSides> sides = mesh_.sides_of(a, b);
  if (!sides) return std::nullopt;
  const Point &at_a = mesh_.points[a], &at_b = mesh_.points[b];
  const auto both = [&](PointKind kind) { return at_a.kind == kind && at_b.kind == kind; };
  const bool may_both_move =
      both(PointKind::interior) || (both(PointKind::seam) && sides->is_border() && !at_a.is_joint && !at_b.is_joint);
  if (seams == Seams::kept && may_both_move) {
    if (attempt == 0) return move_both(a, b, *sides);
    --attempt;
  }
  // An edge from seam to seam through a chart stays: to contract it would pinch the chart.
  const bool is_across = at_a.kind != PointKind::interior && at_b.kind != PointKind::interior && !sides->is_seam();
  if (seams == Seams::kept && (is_across || attempt >= 2)) return std::nullopt;
  constexpr std::array<unsigned, 4> ways{0, 3, 1, 2};
  if (attempt >= 2 * ways.size()) return std::nullopt;
  const unsigned stays = ways[attempt / 2];
  std::optional<Collapse> first, second;
  if (may_go(a, b, *sides, seams)) first = keep(b, a, *sides, stays);
  if (may_go(b, a, *sides, seams)) second = keep(a, b, reversed(*sides), stays);
  if (!first || (second && second->cost < first->cost)) std::swap(first, second);
  std::optional<Collapse>& chosen = attempt % 2 == 0 ? first : second;
  if (chosen) chosen->seams = seams;
  return chosen;
}

std::optional<Collapse> Collapser::move_both(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const {
  DeviationQuadric q = mesh_.quadrics[sides.at_a[0]];
  q += mesh_.quadrics[sides.at_b[0]];
  const Uv u = scaled(mesh_.wedges[sides.at_a[0]].uv), v = scaled(mesh_.wedges[sides.at_b[0]].uv);
  const Uv middle{0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1])};
  const std::optional<Uv> best = sides.is_border() ? rim_place(q, middle, sides) : q.best_place(middle);
  if (!best) return std::nullopt;
  // Far from both, the maps that were added up say nothing.
  if (std::hypot((*best)[0] - middle[0], (*best)[1] - middle[1]) > std::hypot(u[0] - v[0], u[1] - v[1]))
    return std::nullopt;
  const PositionQuadric at_best = q.at(*best);
  const std::optional<Vec3d> p = at_best.minimiser();
  if (!p) return std::nullopt;
  return Collapse{a, b, sides, sides.at_b, *p, best, std::max(at_best.value(*p), 0.0)};
}

// On a rim: where the new one, from the neighbour before to the one behind, has all of the old one on its outer side.
std::optional<Uv> Collapser::rim_place(const DeviationQuadric& q, const Uv& middle, const EdgeSides& sides) const {
  const std::optional<DeviationQuadric::Reduced> model = q.reduced(middle);
  if (!model) return std::nullopt;
  const int sign = sign_[mesh_.wedges[sides.at_a[0]].region];
  std::array<HalfPlane, 4> allowed;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t wedge = i == 0 ? sides.at_a[0] : sides.at_b[0];
    const WedgeMesh::Outline outline = mesh_.outline_at(full_, wedge);
    if (outline.edges != 2) return std::nullopt;
    const Uv own = scaled(mesh_.wedges[wedge].uv);
    const double margin = rounding * full_.uv_scale();
    allowed[2 * i] = HalfPlane::beside(scaled(outline.before), own, sign, margin);
    allowed[2 * i + 1] = HalfPlane::beside(own, scaled(outline.behind), sign, margin);
  }
  return best_place_within(*model, middle, allowed);
}

std::optional<Collapse> Collapser::keep(std::uint32_t kept, std::uint32_t removed, const EdgeSides& sides,
                                        unsigned stays) const {
  std::array<std::uint32_t, 2> into = sides.at_b;
  if (sides.at_a[0] == sides.at_a[1]) {
    if (stays == 1 || stays == 2) return std::nullopt; // it is one wedge
    if (stays == 0 && sides.at_b[0] != sides.at_b[1]) return std::nullopt;
  }
  for (std::size_t i = 0; i < 2; ++i)
    if ((stays >> i & 1U) != 0) into[i] = sides.at_a[i];
  PositionQuadric sum;
  const auto add = [&](std::uint32_t quadric, std::uint32_t place) {
    sum += mesh_.quadrics[quadric].at(scaled(mesh_.wedges[place].uv));
  };
  std::array<std::uint32_t, 64> seen; // a point where more regions meet is kept exact by those that fit
  std::size_t count = 0;
  const auto add_all = [&](std::uint32_t point) {
    mesh_.for_each_corner(point, [&](std::uint32_t corner) {
      const std::uint32_t wedge = mesh_.triangles[corner / 3][corner % 3];
      if (std::find(seen.begin(), seen.begin() + count, wedge) != seen.begin() + count || count == seen.size()) return;
      seen[count++] = wedge;
      add(wedge, wedge == sides.at_a[0] ? into[0] : wedge == sides.at_a[1] ? into[1] : wedge);
    });
  };
  add_all(removed);
  add_all(kept);
  const Vec3d own = mesh_.points[kept].position;
  const Vec3d p = mesh_.points[kept].is_joint ? own : sum.minimiser().value_or(own);
  return Collapse{removed, kept, sides, into, p, std::nullopt, std::max(sum.value(p), 0.0)};
}

std::optional<Collapser::Goal> Collapser::goal_of(const Collapse& collapse) const {
  const Wedge& wedge = mesh_.wedges[collapse.sides.at_b[0]];
  Goal goal{
      collapse.position, mesh_.points[collapse.kept].sphere, wedge.uv, {}, collapse.moved_to.has_value(), false, 0};
  if (!goal.has_moved) return goal;
  goal.uv = {static_cast<float>((*collapse.moved_to)[0] / full_.uv_scale()),
             static_cast<float>((*collapse.moved_to)[1] / full_.uv_scale())};
  const std::optional<Place> place = full_.chart_map().locate({goal.uv.x, goal.uv.y}, wedge.near);
  if (!place) return std::nullopt;
  goal.place = *place;
  goal.sphere = full_.sphere_point(*place);
  return goal;
}

bool Collapser::keeps_outline(const Collapse& collapse, double& drift) const {
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
    return false;
  }
  return false;
}

// Whether the outline of the chart, where it passes at a wedge, cuts off only what the chart has if it passes at `to`
// in its place.
bool Collapser::stays_inside(std::uint32_t wedge, const Vec2f& to) const {
  const WedgeMesh::Outline outline = mesh_.outline_at(full_, wedge);
  if (outline.edges != 2) return outline.edges == 0;
  const Vec2f& own = mesh_.wedges[wedge].uv;
  const int wrong = -sign_[mesh_.wedges[wedge].region];
  return uv_orientation(outline.before, own, to) != wrong && uv_orientation(own, outline.behind, to) != wrong;
}

bool Collapser::keeps_charts(const Collapse& collapse, const Goal& goal) const {
  const auto& [at_removed, at_kept, triangles] = collapse.sides;
  if (goal.has_moved)
    return !collapse.sides.is_border() || (stays_inside(at_removed[0], goal.uv) && stays_inside(at_kept[0], goal.uv));
  if (mesh_.points[collapse.removed].kind == PointKind::interior) return true;
  for (std::size_t i = 0; i < 2; ++i) {
    if (i == 1 && at_removed[1] == at_removed[0]) break;
    if (collapse.into[i] != at_removed[i] && !stays_inside(at_removed[i], mesh_.wedges[collapse.into[i]].uv))
      return false;
  }
  return true;
}

bool Collapser::keeps_triangles(const Collapse& collapse, const Goal& goal) const {
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
                       : own == collapse.sides.at_a[0] ? mesh_.wedges[collapse.into[0]].uv
                       : own == collapse.sides.at_a[1] ? mesh_.wedges[collapse.into[1]].uv
                                                       : mesh_.wedges[own].uv;
      if (uv_orientation(uv, mesh_.wedges[next].uv, mesh_.wedges[last].uv) != sign_[mesh_.wedges[own].region])
        return false;
    }
    if ((goal.has_moved || goal.has_turned || !is_at_kept) && sphere::orientation(goal.sphere, p.sphere, q.sphere) != 1)
      return false;
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

// The last wedge of a point in the primitive of this one; null where there is none.
const Wedge* Collapser::same_primitive_at(std::uint32_t point, const Wedge& wedge) const {
  const Wedge* found = nullptr;
  mesh_.for_each_corner(point, [&](std::uint32_t corner) {
    const Wedge& other = mesh_.wedges[mesh_.triangles[corner / 3][corner % 3]];
    if (full_.primitive_of(other.region) == full_.primitive_of(wedge.region)) found = &other;
  });
  return found;
}

// Whether all wedges of the removed point that stay in the atlas find one of their own primitive at the kept point,
// whose attributes they can take: else the two sides of a border between primitives would move apart in a morph.
bool Collapser::finds_attributes(const Collapse& collapse) const {
  bool all = true;
  mesh_.for_each_corner(collapse.removed, [&](std::uint32_t corner) {
    if (corner / 3 == collapse.sides.triangle[0] || corner / 3 == collapse.sides.triangle[1]) return;
    const std::uint32_t w = mesh_.triangles[corner / 3][corner % 3];
    all = all && (!collapse.stays(w) || same_primitive_at(collapse.kept, mesh_.wedges[w]) != nullptr);
  });
  return all;
}

std::optional<Collapser::Goal> Collapser::check(const Collapse& collapse) {
  double drift = 0;
  const bool breaks = collapse.seams == Seams::broken;
  if (mesh_.points[collapse.removed].kind == PointKind::seam && !collapse.sides.is_border() &&
      !keeps_outline(collapse, drift) && !breaks)
    return std::nullopt;
  if (breaks && !finds_attributes(collapse)) return std::nullopt;
  if (!mesh_.link_condition(collapse.removed, collapse.kept, collapse.sides, breaks)) return std::nullopt;
  std::optional<Goal> goal = goal_of(collapse);
  if (!goal || !keeps_charts(collapse, *goal)) return std::nullopt;
  if (!keeps_triangles(collapse, *goal)) {
    if (!breaks || goal->has_moved) return std::nullopt;
    // The points that the last few triangles would need may not be there: half way between the two is one more.
    const Vec3d a(sphere::from_grid(mesh_.points[collapse.removed].sphere)), b(sphere::from_grid(goal->sphere));
    goal->sphere = sphere::to_grid(normalized(a + b));
    goal->has_turned = true;
    if (!keeps_triangles(collapse, *goal)) return std::nullopt;
  }
  goal->drift = drift;
  return goal;
}

std::span<const std::uint32_t> Collapser::perform(const Collapse& collapse) {
  kept_.clear();
  const std::optional<Goal> goal = check(collapse);
  if (!goal) return {};
  steps_.assign(1, {collapse, *goal});
  if (mesh_.points[collapse.removed].joint != none && constraints.keeps_joints && !add_twins(collapse)) return {};
  for (const Step& step : steps_) {
    apply(step);
    kept_.push_back(step.collapse.kept);
  }
  return kept_;
}

// The same for all other points at the place of the removed one, if that is possible, and all of it at once.
bool Collapser::add_twins(const Collapse& collapse) {
  const std::uint32_t joint = mesh_.points[collapse.kept].joint;
  for (const std::uint32_t twin : mesh_.at_joint[mesh_.points[collapse.removed].joint]) {
    if (twin == collapse.removed || !mesh_.points[twin].is_alive) continue;
    const std::optional<Step> step = twin_step(twin, joint, collapse.seams);
    if (!step) return false;
    steps_.push_back(*step);
  }
  return are_apart();
}

std::optional<Collapser::Step> Collapser::twin_step(std::uint32_t twin, std::uint32_t joint, Seams seams) {
  std::vector<std::uint32_t> ring;
  mesh_.neighbours_of(twin, ring);
  for (const std::uint32_t q : ring) {
    if (mesh_.points[q].joint != joint) continue;
    const std::optional<EdgeSides> sides = mesh_.sides_of(twin, q);
    if (!sides || !may_go(twin, q, *sides, seams)) continue;
    for (const unsigned stays : {0U, 3U}) {
      if (stays != 0 && seams == Seams::kept) break;
      std::optional<Collapse> collapse = keep(q, twin, *sides, stays);
      if (!collapse) continue;
      collapse->seams = seams;
      if (const std::optional<Goal> goal = check(*collapse)) return Step{*collapse, *goal};
    }
  }
  return std::nullopt;
}

// Whether no triangle is touched by two of the steps: then what was checked for each holds for all.
bool Collapser::are_apart() const {
  std::vector<std::uint32_t> all, own;
  for (const Step& step : steps_) {
    own.clear();
    for (const std::uint32_t p : {step.collapse.removed, step.collapse.kept})
      mesh_.for_each_corner(p, [&](std::uint32_t c) { own.push_back(c / 3); });
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    all.insert(all.end(), own.begin(), own.end());
  }
  std::sort(all.begin(), all.end());
  return std::adjacent_find(all.begin(), all.end()) == all.end();
}

void Collapser::apply(const Step& step) {
  const auto& [collapse, goal] = step;
  const bool breaks = collapse.seams == Seams::broken;
  if (breaks) tear(collapse);
  Point &kept = mesh_.points[collapse.kept], &removed = mesh_.points[collapse.removed];
  mesh_.contract(collapse.removed, collapse.kept, collapse.sides, collapse.into);
  const bool has_more = breaks && removed.kind != PointKind::interior; // wedges than its kind says
  kept.kind = has_more ? PointKind::fixed : std::max(kept.kind, removed.kind);
  kept.position = goal.position;
  kept.drift = std::max(kept.drift, static_cast<float>(goal.drift));
  kept.sphere = goal.sphere;
  ++kept.version;
  if (!goal.has_moved) return;
  Wedge& wedge = mesh_.wedges[collapse.sides.at_b[0]];
  wedge.uv = goal.uv;
  wedge.source = full_.cut().parent[goal.place.triangle];
  wedge.weights = full_.weights_on_parent(goal.place);
  wedge.near = goal.place.triangle;
}

// Wedges that stay in the atlas take the attributes of the kept point, and at an edge that is torn new seams begin.
void Collapser::tear(const Collapse& collapse) {
  const EdgeSides& sides = collapse.sides;
  mesh_.for_each_corner(collapse.removed, [&](std::uint32_t corner) {
    const std::uint32_t w = mesh_.triangles[corner / 3][corner % 3];
    Wedge& wedge = mesh_.wedges[w];
    const Wedge* const kept = collapse.stays(w) ? same_primitive_at(collapse.kept, wedge) : nullptr;
    if (kept == nullptr) return;
    wedge.source = kept->source;
    wedge.weights = kept->weights;
  });
  if (!collapse.tears()) return;
  for (const std::uint32_t t : sides.triangle)
    for (const std::uint32_t w : mesh_.triangles[t]) mesh_.points[mesh_.wedges[w].point].kind = PointKind::fixed;
}

} // namespace orbis::lod
