#include "core/mesh/shared_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace orbis::mesh {
namespace {

constexpr std::size_t most_sides = 64;

// A half-edge with the angle at which its triangle stands about the edge.
struct Side {
  std::uint32_t half_edge;
  double angle; // radians
};

struct Candidate {
  bool other_vertices; // of the input: seams are no connection
  std::int64_t bend;   // how far from flat, in microradians
  double inside;       // the angle that the pair encloses, 0 to 2 pi
  std::uint32_t up, down;
  auto operator<=>(const Candidate&) const = default;
};

class Edge {
public:
  Edge(std::span<const Vec3f> positions, std::span<const Triangle> corners, std::span<const std::uint32_t> sides,
       Gluing& gluing)
      : corners_(corners), gluing_(gluing) {
    const Index low = std::min(gluing.from(sides[0]), gluing.to(sides[0]));
    const Index high = std::max(gluing.from(sides[0]), gluing.to(sides[0]));
    const Vec3d origin(positions[low]), axis = Vec3d(positions[high]) - origin;
    Vec3d right = cross(axis, std::abs(axis.x) < std::abs(axis.y) ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
    const Vec3d ahead = cross(axis, right);
    for (const std::uint32_t h : sides) {
      const Vec3d apex = Vec3d(positions[gluing.from(previous_in_triangle(h))]) - origin;
      // `ahead` is |axis| times as long as `right`.
      const double angle = std::atan2(dot(apex, ahead), dot(apex, right) * norm(axis));
      (gluing.from(h) == low ? up_ : down_).push_back({h, angle});
    }
  }

  void glue() {
    std::vector<Candidate> candidates;
    for (const Side& u : up_) {
      for (const Side& d : down_) {
        const Triangle &s = gluing_.triangles[u.half_edge / 3], &t = gluing_.triangles[d.half_edge / 3];
        if (!have_same_points(s, t)) candidates.push_back(candidate(u, d));
      }
    }
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate& c : candidates) {
      if (gluing_.is_open(c.up) && gluing_.is_open(c.down)) gluing_.glue(c.up, c.down);
    }
  }

private:
  // A triangle that runs up has its inside clockwise from it, one that runs down counter-clockwise.
  [[nodiscard]] Candidate candidate(const Side& u, const Side& d) const {
    double inside = u.angle - d.angle;
    if (inside < 0) inside += 2 * std::numbers::pi;
    const auto bend = static_cast<std::int64_t>(std::llround(1e6 * std::abs(inside - std::numbers::pi)));
    const bool same_vertices = corner(u.half_edge) == corner(next_in_triangle(d.half_edge)) &&
                               corner(next_in_triangle(u.half_edge)) == corner(d.half_edge);
    return {!same_vertices, bend, inside, u.half_edge, d.half_edge};
  }
  [[nodiscard]] Index corner(std::uint32_t c) const { return corners_[c / 3][c % 3]; }

  std::span<const Triangle> corners_;
  Gluing& gluing_;
  std::vector<Side> up_, down_;
};

// An edge of the surface between fans a < b: the half-edge from a to b and the one back, as far as there are any.
struct GluedEdge {
  Index a, b;
  std::uint32_t up = open_edge, down = open_edge;
};

GluedEdge edge_at(const Gluing& gluing, const Fans& fans, std::uint32_t h) {
  const Index from = fans.of_corner[h], to = fans.of_corner[next_in_triangle(h)];
  if (from < to) return {from, to, h, gluing.twin[h]};
  return {to, from, gluing.twin[h], h};
}

// The two edges of a double one, or nothing.
std::optional<std::pair<GluedEdge, GluedEdge>> double_edge(const Gluing& gluing, const Fans& fans,
                                                           std::span<const std::uint32_t> sides) {
  std::vector<GluedEdge> edges;
  for (const std::uint32_t h : sides) {
    if (!gluing.is_open(h) && gluing.twin[h] < h) continue; // seen from its other side
    edges.push_back(edge_at(gluing, fans, h));
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const GluedEdge& e, const GluedEdge& f) { return std::tie(e.a, e.b) < std::tie(f.a, f.b); });
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i - 1].a == edges[i].a && edges[i - 1].b == edges[i].b) return std::pair{edges[i - 1], edges[i]};
  }
  return std::nullopt;
}

// Glues crosswise what was glued straight. A side that is not there leaves its partner open.
void cross_over(Gluing& gluing, const GluedEdge& e, const GluedEdge& f) {
  const auto join = [&](std::uint32_t up, std::uint32_t down) {
    if (up != open_edge) gluing.twin[up] = down;
    if (down != open_edge) gluing.twin[down] = up;
  };
  join(e.up, f.down);
  join(f.up, e.down);
}

std::uint64_t open_pillows(Gluing& gluing) {
  std::uint64_t count = 0;
  for (std::uint32_t t = 0; t < gluing.triangles.size(); ++t) {
    const std::uint32_t h = gluing.twin[3 * t];
    if (h == open_edge) continue;
    const auto meets = [&](std::uint32_t side) { return !gluing.is_open(side) && gluing.twin[side] / 3 == h / 3; };
    if (!meets(3 * t + 1) || !meets(3 * t + 2)) continue;
    for (std::uint32_t k = 0; k < 3; ++k) gluing.unglue(3 * t + k);
    count += 3;
  }
  return count;
}

} // namespace

void glue_shared_edges(std::span<const Vec3f> positions, std::span<const Triangle> corners, const SharedEdges& shared,
                       Gluing& gluing) {
  for (const std::vector<std::uint32_t>& sides : shared) {
    if (sides.size() <= most_sides) Edge(positions, corners, sides, gluing).glue();
  }
}

std::uint64_t separate_double_edges(const SharedEdges& shared, Gluing& gluing) {
  std::uint64_t count = 0;
  // Each change pinches a fan into two, or closes a loop: there is an end.
  for (bool changed = !shared.empty(); changed;) {
    changed = false;
    const Fans fans = fans_of(gluing);
    std::vector<bool> stale(fans.count, false);
    for (const std::vector<std::uint32_t>& sides : shared) {
      const auto found = double_edge(gluing, fans, sides);
      if (!found) continue;
      changed = true; // now, or in the next round where the fans have changed already
      const auto& [e, f] = *found;
      if (stale[e.a] || stale[e.b]) continue;
      stale[e.a] = stale[e.b] = true;
      cross_over(gluing, e, f);
      ++count;
    }
  }
  return count + open_pillows(gluing);
}

} // namespace orbis::mesh
