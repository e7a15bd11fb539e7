#include "core/lod/wedge_mesh.h"

#include <algorithm>

namespace orbis::lod {
namespace {

// Where the map from the atlas stretches far more than elsewhere, it says little about its neighbourhood: beyond this
// many times the mean stretch the slip counts less.
constexpr double usual_stretch = 4;
constexpr std::size_t grain = 1024; // points
constexpr double wall_weight = 1;   // of the squared distance from a rim's edge, times the edge's squared length

DeviationQuadric quadric_of(const FullSurface& full, std::uint32_t t) {
  const auto& [ia, ib, ic] = full.cut().triangles[t];
  const Vec3d a = full.positions()[ia], e1 = full.positions()[ib] - a, e2 = full.positions()[ic] - a;
  const auto& [weight, own_slip] = full.weighing(t);
  if (!(weight > 0)) return {};
  const Vec3d& n = full.normal(t);

  const double scale = full.uv_scale();
  const auto uv = [&](mesh::Index v) {
    return Uv{scale * full.cut().vertices[v].uv.x, scale * full.cut().vertices[v].uv.y};
  };
  const Uv u0 = uv(ia), u1 = uv(ib), u2 = uv(ic);
  const double a00 = u1[0] - u0[0], a01 = u1[1] - u0[1], a10 = u2[0] - u0[0], a11 = u2[1] - u0[1];
  const double determinant = a00 * a11 - a01 * a10;
  if (determinant == 0) return DeviationQuadric::of_map({}, a, n, weight, 0);
  // e1 = A (a00, a01), e2 = A (a10, a11)
  const std::array<Vec3d, 2> map{(e1 * a11 - e2 * a01) * (1 / determinant), (e2 * a00 - e1 * a10) * (1 / determinant)};
  const double stretch = squared_norm(map[0]) + squared_norm(map[1]);
  const double trust = std::min(1.0, usual_stretch * usual_stretch / stretch);
  return DeviationQuadric::of_map(map, a - map[0] * u0[0] - map[1] * u0[1], n, weight, own_slip * trust);
}

} // namespace

WedgeMesh::WedgeMesh(const FullSurface& full, mesh::ThreadPool& threads) : uv_scale_(full.uv_scale()) {
  make_wedges(full);
  list_corners();
  classify(threads);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const DeviationQuadric q = quadric_of(full, t);
    for (const std::uint32_t w : triangles[t]) quadrics[w] += q;
  }
  wall_borders(full);
}

// The copies of a point that one region sees at one place in the atlas are one wedge: levels keep the seams of the
// atlas and of the materials, not those of the input's own attributes.
void WedgeMesh::make_wedges(const FullSurface& full) {
  const texture::CutMesh& cut = full.cut();
  points.resize(cut.points);
  parent.assign(cut.parent.begin(), cut.parent.end());
  triangles.reserve(cut.triangles.size());
  corner_points.reserve(cut.triangles.size());
  std::vector<std::uint32_t> first(cut.points, none), next;
  const auto wedge_of = [&](mesh::Index v, std::uint32_t t) {
    const texture::CutVertex& vertex = cut.vertices[v];
    const std::uint32_t region = full.regions()[t];
    for (std::uint32_t w = first[vertex.point]; w != none; w = next[w])
      if (wedges[w].region == region && wedges[w].uv == vertex.uv) return w;
    const auto made = static_cast<std::uint32_t>(wedges.size());
    wedges.push_back({vertex.point, region, vertex.uv, vertex.triangle, vertex.barycentric, t});
    next.push_back(first[vertex.point]);
    first[vertex.point] = made;
    points[vertex.point].position = full.positions()[v];
    points[vertex.point].sphere = vertex.sphere;
    points[vertex.point].is_joint = full.is_joint(vertex);
    points[vertex.point].joint = full.joint_of(vertex);
    return made;
  };
  for (std::uint32_t t = 0; t < cut.triangles.size(); ++t) {
    const auto& [a, b, c] = cut.triangles[t];
    triangles.push_back({wedge_of(a, t), wedge_of(b, t), wedge_of(c, t)});
    corner_points.push_back({cut.vertices[a].point, cut.vertices[b].point, cut.vertices[c].point});
  }
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    if (points[p].joint == none) continue;
    if (points[p].joint >= at_joint.size()) at_joint.resize(points[p].joint + 1);
    at_joint[points[p].joint].push_back(p);
  }
  is_alive.assign(triangles.size(), true);
  triangle_count = triangles.size();
  quadrics.resize(wedges.size());
  mark_.assign(points.size(), 0);
}

void WedgeMesh::list_corners() {
  next_corner_.assign(3 * triangles.size(), none);
  for (auto c = static_cast<std::uint32_t>(next_corner_.size()); c-- > 0;) {
    Point& point = points[point_at(c)];
    next_corner_[c] = point.first_corner;
    point.first_corner = c;
  }
}

void WedgeMesh::classify(mesh::ThreadPool& threads) {
  threads.for_blocks(points.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> ring;
    for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p) {
      points[p].is_alive = points[p].first_corner != none;
      neighbours_of(p, ring);
      int seams = 0;
      bool is_regular = true;
      for (const std::uint32_t q : ring) {
        const std::optional<EdgeSides> sides = sides_of(p, q);
        is_regular = is_regular && sides.has_value();
        seams += sides && sides->is_seam() ? 1 : 0;
      }
      if (seams == 0 && is_regular && !points[p].is_joint) continue;
      const bool may_go = !points[p].is_joint || points[p].joint != none;
      points[p].kind = seams == 2 && is_regular && may_go ? PointKind::seam : PointKind::fixed;
    }
  });
}

// Where the surface ends, nothing but its rim says where, and nothing but the border between two primitives says where
// one begins to look like the other: planes through the edges, across the surface (Garland and Heckbert 1997, section
// 6).
void WedgeMesh::wall_borders(const FullSurface& full) {
  std::vector<std::uint32_t> ring;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    if (points[p].kind == PointKind::interior) continue;
    neighbours_of(p, ring);
    for (const std::uint32_t q : ring) {
      if (q < p) continue;
      const std::optional<EdgeSides> sides = sides_of(p, q);
      if (!sides) continue;
      const auto primitive = [&](std::size_t i) { return full.primitive_of(wedges[sides->at_a[i]].region); };
      if (!sides->is_border() && primitive(0) == primitive(1)) continue;
      for (std::size_t i = 0; i < (sides->is_border() ? 1U : 2U); ++i) wall(*sides, i, p, q);
    }
  }
}

// On one side of the edge (p, q).
void WedgeMesh::wall(const EdgeSides& sides, std::size_t side, std::uint32_t p, std::uint32_t q) {
  const mesh::Triangle& t = triangles[sides.triangle[side]];
  const Vec3d a = points[wedges[t[0]].point].position;
  const Vec3d normal = cross(points[wedges[t[1]].point].position - a, points[wedges[t[2]].point].position - a);
  const Vec3d edge = points[q].position - points[p].position, across = cross(edge, normal);
  const double length = norm(across);
  if (!(length > 0)) return;
  const auto plane =
      DeviationQuadric::of_plane(points[p].position, across * (1 / length), wall_weight * squared_norm(edge));
  quadrics[sides.at_a[side]] += plane;
  quadrics[sides.at_b[side]] += plane;
}

bool WedgeMesh::is_on_border(std::uint32_t point) const {
  if (points[point].kind == PointKind::interior) return false;
  std::vector<std::uint32_t> ring;
  neighbours_of(point, ring);
  return std::any_of(ring.begin(), ring.end(), [&](std::uint32_t q) {
    const std::optional<EdgeSides> sides = sides_of(point, q);
    return sides && sides->is_border();
  });
}

bool WedgeMesh::is_between_joints(std::uint32_t point) const {
  std::vector<std::uint32_t> ring;
  neighbours_of(point, ring);
  return std::all_of(ring.begin(), ring.end(), [&](std::uint32_t q) {
    if (points[q].joint != none) return true;
    const std::optional<EdgeSides> sides = sides_of(point, q);
    return !sides || !sides->is_border();
  });
}

WedgeMesh::Outline WedgeMesh::outline_at(const FullSurface& full, std::uint32_t wedge) const {
  const std::uint32_t point = wedges[wedge].point, chart = full.chart_of(wedges[wedge].region);
  // Whether a triangle of the chart has the edge from here to `other` on its other side: as its `k`-th after this.
  const auto is_continued = [&](std::uint32_t other, std::uint32_t k) {
    bool found = false;
    for_each_corner(point, [&](std::uint32_t c) {
      const std::uint32_t own = triangles[c / 3][c % 3], x = triangles[c / 3][(c % 3 + k) % 3];
      found = found || (wedges[x].point == wedges[other].point && wedges[x].uv == wedges[other].uv &&
                        wedges[own].uv == wedges[wedge].uv && full.chart_of(wedges[own].region) == chart);
    });
    return found;
  };
  Outline out;
  for_each_corner(point, [&](std::uint32_t c) {
    if (triangles[c / 3][c % 3] != wedge) return;
    const std::uint32_t next = triangles[c / 3][(c % 3 + 1) % 3], last = triangles[c / 3][(c % 3 + 2) % 3];
    if (!is_continued(next, 2)) {
      out.behind = wedges[next].uv;
      ++out.edges;
    }
    if (!is_continued(last, 1)) {
      out.before = wedges[last].uv;
      ++out.edges;
    }
  });
  return out;
}

std::optional<EdgeSides> WedgeMesh::sides_of(std::uint32_t a, std::uint32_t b) const {
  EdgeSides sides;
  std::size_t found = 0;
  for_each_corner(a, [&](std::uint32_t corner) {
    const mesh::Triangle& at = corner_points[corner / 3];
    for (std::size_t k = 1; k < 3; ++k) {
      const std::size_t other = (corner % 3 + k) % 3;
      if (at[other] != b) continue;
      if (found < 2) {
        sides.at_a[found] = triangles[corner / 3][corner % 3];
        sides.at_b[found] = triangles[corner / 3][other];
        sides.triangle[found] = corner / 3;
      }
      ++found;
    }
  });
  if (found == 0 || found > 2) return std::nullopt;
  if (found == 1) {
    sides.at_a[1] = sides.at_a[0];
    sides.at_b[1] = sides.at_b[0];
    sides.triangle[1] = sides.triangle[0];
  }
  return sides;
}

void WedgeMesh::neighbours_of(std::uint32_t point, std::vector<std::uint32_t>& out) const {
  out.clear();
  for_each_corner(point, [&](std::uint32_t corner) {
    for (std::uint32_t k = 1; k < 3; ++k) {
      const std::uint32_t q = point_at(corner - corner % 3 + (corner % 3 + k) % 3);
      if (std::find(out.begin(), out.end(), q) == out.end()) out.push_back(q);
    }
  });
}

bool WedgeMesh::link_condition(std::uint32_t a, std::uint32_t b, const EdgeSides& sides, bool closes_holes) {
  marks_ += 2;
  std::uint32_t around_a = 0, around_b = 0, common = 0;
  const auto for_each_neighbour = [&](std::uint32_t p, auto visit) {
    for_each_corner(p, [&](std::uint32_t corner) {
      for (std::uint32_t k = 1; k < 3; ++k) visit(point_at(corner - corner % 3 + (corner % 3 + k) % 3));
    });
  };
  for_each_neighbour(a, [&](std::uint32_t q) {
    around_a += mark_[q] != marks_ - 1 ? 1 : 0;
    mark_[q] = marks_ - 1;
  });
  for_each_neighbour(b, [&](std::uint32_t q) {
    common += mark_[q] == marks_ - 1 ? 1 : 0;
    around_b += mark_[q] != marks_ ? 1 : 0;
    mark_[q] = marks_;
  });
  // Two neighbours each at a border's edge: a triangle by itself. Three each at an inner edge: a tetrahedron.
  if (!sides.is_border()) return common == 2 && around_a + around_b > 6 && !(is_on_border(a) && is_on_border(b));
  if (common == 1) return around_a + around_b > 4;
  return closes_holes && common == 2 && around_a + around_b > 6 && is_hole_of_three(a, b, sides);
}

// Whether the border's edge (a, b) and two more close a ring.
bool WedgeMesh::is_hole_of_three(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const {
  std::vector<std::uint32_t> ring;
  neighbours_of(a, ring);
  return std::any_of(ring.begin(), ring.end(), [&](std::uint32_t c) {
    if (c == b || std::any_of(triangles[sides.triangle[0]].begin(), triangles[sides.triangle[0]].end(),
                              [&](std::uint32_t w) { return wedges[w].point == c; }))
      return false;
    const std::optional<EdgeSides> ac = sides_of(a, c), bc = sides_of(b, c);
    return ac && bc && ac->is_border() && bc->is_border();
  });
}

void WedgeMesh::contract(std::uint32_t removed, std::uint32_t kept, const EdgeSides& sides,
                         const std::array<std::uint32_t, 2>& into) {
  for (const std::uint32_t t : sides.triangle) is_alive[t] = false;
  triangle_count -= sides.is_border() ? 1 : 2;
  const auto& from = sides.at_a;
  for (std::size_t i = 0; i < 2; ++i)
    if (into[i] != from[i] && (i == 0 || from[1] != from[0])) quadrics[into[i]] += quadrics[from[i]];

  // The kept point's list: its own corners and those that it takes over, without the dead.
  std::uint32_t* link = &points[kept].first_corner;
  const auto append_alive = [&](std::uint32_t c) {
    while (c != none) {
      const std::uint32_t next = next_corner_[c];
      if (is_alive[c / 3]) {
        std::uint32_t& wedge = triangles[c / 3][c % 3];
        if (wedge == from[0])
          wedge = into[0];
        else if (wedge == from[1])
          wedge = into[1];
        wedges[wedge].point = kept;
        corner_points[c / 3][c % 3] = kept;
        *link = c;
        link = &next_corner_[c];
      }
      c = next;
    }
  };
  const std::uint32_t own = points[kept].first_corner, taken = points[removed].first_corner;
  append_alive(own);
  append_alive(taken);
  *link = none;
  points[removed].first_corner = none;
  points[removed].is_alive = false;
  ++points[removed].version;
  for (std::size_t i = 0; i < 2; ++i)
    if (into[i] == from[i]) wedges[from[i]].point = kept;
  for (const std::uint32_t t : sides.triangle)
    for (const std::uint32_t w : triangles[t]) inherit(w);
}

// A wedge without a triangle leaves its quadric, at its place in the atlas, to another wedge of its point: what its
// part of the surface is off by is not forgotten with it.
void WedgeMesh::inherit(std::uint32_t wedge) {
  const std::uint32_t point = wedges[wedge].point;
  if (!points[point].is_alive || quadrics[wedge].weight == 0) return;
  std::uint32_t heir = none;
  bool is_used = false;
  for_each_corner(point, [&](std::uint32_t corner) {
    const std::uint32_t w = triangles[corner / 3][corner % 3];
    is_used = is_used || w == wedge;
    if (heir == none) heir = w;
  });
  if (is_used || heir == none) return;
  const Uv at{uv_scale_ * wedges[wedge].uv.x, uv_scale_ * wedges[wedge].uv.y};
  quadrics[heir] += DeviationQuadric::held_at(quadrics[wedge].at(at), quadrics[wedge].weight);
  quadrics[wedge] = {};
}

std::uint64_t WedgeMesh::remove_component(std::uint32_t point) {
  std::vector<std::uint32_t> members{point}, ring;
  points[point].is_alive = false;
  for (std::size_t i = 0; i < members.size(); ++i) {
    ++points[members[i]].version;
    neighbours_of(members[i], ring);
    for (const std::uint32_t q : ring) {
      if (!points[q].is_alive) continue;
      points[q].is_alive = false;
      members.push_back(q);
    }
  }
  const std::uint64_t before = triangle_count;
  for (const std::uint32_t p : members) {
    for_each_corner(p, [&](std::uint32_t corner) {
      is_alive[corner / 3] = false;
      --triangle_count;
    });
  }
  return before - triangle_count;
}

} // namespace orbis::lod
