#include "core/lod/wedge_mesh.h"

#include <algorithm>

namespace orbis::lod {
namespace {

// Where the map from the atlas stretches far more than elsewhere, it says little about its neighbourhood: beyond this
// many times the mean stretch the slip counts less.
constexpr double usual_stretch = 4;

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

WedgeMesh::WedgeMesh(const FullSurface& full) {
  make_wedges(full);
  list_corners();
  classify();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const DeviationQuadric q = quadric_of(full, t);
    for (const std::uint32_t w : triangles[t]) quadrics[w] += q;
  }
}

// The copies of a point that one region sees at one place in the atlas are one wedge: levels keep the seams of the
// atlas and of the materials, not those of the input's own attributes.
void WedgeMesh::make_wedges(const FullSurface& full) {
  const texture::CutMesh& cut = full.cut();
  points.resize(cut.points);
  parent.assign(cut.parent.begin(), cut.parent.end());
  triangles.reserve(cut.triangles.size());
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
    return made;
  };
  for (std::uint32_t t = 0; t < cut.triangles.size(); ++t) {
    const auto& [a, b, c] = cut.triangles[t];
    triangles.push_back({wedge_of(a, t), wedge_of(b, t), wedge_of(c, t)});
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

void WedgeMesh::classify() {
  std::vector<std::uint32_t> ring;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
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
    points[p].kind = seams == 2 && is_regular && !points[p].is_joint ? PointKind::seam : PointKind::fixed;
  }
}

std::optional<EdgeSides> WedgeMesh::sides_of(std::uint32_t a, std::uint32_t b) const {
  EdgeSides sides;
  std::size_t found = 0;
  for_each_corner(a, [&](std::uint32_t corner) {
    const mesh::Triangle& t = triangles[corner / 3];
    for (std::size_t k = 1; k < 3; ++k) {
      const std::uint32_t other = t[(corner % 3 + k) % 3];
      if (wedges[other].point != b) continue;
      if (found < 2) {
        sides.at_a[found] = t[corner % 3];
        sides.at_b[found] = other;
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

bool WedgeMesh::link_condition(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) {
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
  return sides.is_border() ? common == 1 && around_a + around_b > 4 : common == 2 && around_a + around_b > 6;
}

void WedgeMesh::contract(std::uint32_t removed, std::uint32_t kept, const EdgeSides& removed_to_kept) {
  for (const std::uint32_t t : removed_to_kept.triangle) is_alive[t] = false;
  triangle_count -= removed_to_kept.is_border() ? 1 : 2;
  const auto& from = removed_to_kept.at_a;
  const auto& to = removed_to_kept.at_b;
  quadrics[to[0]] += quadrics[from[0]];
  if (from[1] != from[0]) quadrics[to[1]] += quadrics[from[1]];

  // The kept point's list: its own corners and those that it takes over, without the dead.
  std::uint32_t* link = &points[kept].first_corner;
  const auto append_alive = [&](std::uint32_t c) {
    while (c != none) {
      const std::uint32_t next = next_corner_[c];
      if (is_alive[c / 3]) {
        std::uint32_t& wedge = triangles[c / 3][c % 3];
        if (wedge == from[0])
          wedge = to[0];
        else if (wedge == from[1])
          wedge = to[1];
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
