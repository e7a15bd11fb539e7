// A triangle and a face are both convex cones, so what they share is one convex polygon. Its border runs along the
// triangle's boundary where that lies in the face, and between two such runs along the face's own border: from the
// point where the triangle leaves the face, counter-clockwise past the cube's corners on the way, to the point where it
// enters again. Which corners these are follows from the sides on which it leaves and enters: combinatorics alone
// decide what the pieces are, and two triangles that share an edge cannot disagree about it.
#include "core/texture/divide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"

namespace orbis::texture {
namespace {

using sphere::GridPoint;
using Polygon = std::vector<std::uint32_t>; // indices into Division::points, counter-clockwise

[[noreturn]] void refuse() {
  throw Error(ErrorCode::not_certified, "a triangle could not be cut exactly at the borders of the cube's faces");
}

double determinant(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const auto minor = [](std::int64_t p, std::int64_t q, std::int64_t r, std::int64_t s) { return p * s - q * r; };
  __extension__ using Wide = __int128;
  const Wide sum = static_cast<Wide>(a[0]) * minor(b[1], b[2], c[1], c[2]) -
                   static_cast<Wide>(a[1]) * minor(b[0], b[2], c[0], c[2]) +
                   static_cast<Wide>(a[2]) * minor(b[0], b[1], c[0], c[1]);
  return static_cast<double>(sum);
}

GridPoint axis_point(Face f) {
  GridPoint p{};
  p[axis_of(f)] = (f & 1U) != 0 ? -(1 << sphere::grid_bits) : 1 << sphere::grid_bits;
  return p;
}

// The corner of face f between its sides i and i + 1 (sides as in neighbours_of).
GridPoint cube_corner(Face f, std::size_t i) {
  static const auto side = static_cast<std::int32_t>(std::lround(std::ldexp(1 / std::sqrt(3.0), sphere::grid_bits)));
  GridPoint p{};
  for (const Face g : {f, neighbours_of(f)[i % 4], neighbours_of(f)[(i + 1) % 4]})
    p[axis_of(g)] = (g & 1U) != 0 ? -side : side;
  return p;
}

class Divider {
public:
  explicit Divider(std::vector<DividedPoint> boundary) : boundary_(boundary.size()) {
    division_.points = std::move(boundary);
    for (std::size_t i = 0; i < boundary_; ++i) labels_.push_back(face_of_segment(i));
  }

  Division run() {
    for (Face f = 0; f < face_count; ++f) {
      const Polygon polygon = polygon_of(f);
      // A run along a border whose triangle lies on the other side has no area.
      if (polygon.size() >= 3) triangulate(polygon, f);
    }
    check_edges();
    return std::move(division_);
  }

private:
  std::size_t boundary_;     // points on the boundary; cube corners come after them
  std::vector<Face> labels_; // the face in which the boundary runs from point i to the next
  Division division_;

  [[nodiscard]] std::size_t next(std::size_t i) const { return i + 1 == boundary_ ? 0 : i + 1; }
  [[nodiscard]] const DividedPoint& point(std::size_t i) const { return division_.points[i]; }
  [[nodiscard]] const GridPoint& corner(std::size_t k) const {
    const auto site = static_cast<Site>(k);
    return std::find_if(division_.points.begin(), division_.points.end(),
                        [site](const DividedPoint& p) { return p.site == site; })
        ->sphere;
  }

  // Along a border two faces come into question: the triangle lies on the side on which its corners lie together. The
  // two on the border hardly count, and the answer is the same for all of the triangle's segments on this border.
  [[nodiscard]] Face face_of_segment(std::size_t i) const {
    const auto common = static_cast<FaceMask>(point(i).faces & point(next(i)).faces);
    if (common == 0) refuse();
    Face best = face_count;
    for (Face f = 0; f < face_count; ++f)
      if ((common & bit_of(f)) != 0 && (best == face_count || depth(f) > depth(best))) best = f;
    return best;
  }
  [[nodiscard]] std::int64_t depth(Face f) const {
    return std::int64_t{along(corner(0), f)} + along(corner(1), f) + along(corner(2), f);
  }

  // A place on the border of f, in eighths of a turn: odd on a side (2 i + 1 on side i), even at a corner (2 i + 2
  // between sides i and i + 1).
  [[nodiscard]] static std::size_t place_on_border(const DividedPoint& p, Face f) {
    const auto sides = neighbours_of(f);
    const auto lies_in = [&](std::size_t i) { return (p.faces & bit_of(sides[i % 4])) != 0; };
    for (std::size_t i = 0; i < 4; ++i)
      if (lies_in(i) && lies_in(i + 1)) return (2 * i + 2) % 8;
    for (std::size_t i = 0; i < 4; ++i)
      if (lies_in(i)) return 2 * i + 1;
    refuse();
  }

  // Is b ahead of a on side i of f, counter-clockwise?
  [[nodiscard]] static bool ahead(const GridPoint& a, const GridPoint& b, Face f, std::size_t i) {
    const Face onwards = neighbours_of(f)[(i + 1) % 4];
    return std::int64_t{along(b, onwards)} * along(a, f) >= std::int64_t{along(a, onwards)} * along(b, f);
  }

  // The cube's corners between two points, counter-clockwise along the border of f, appended to the polygon.
  void follow_border(Face f, const DividedPoint& from, const DividedPoint& to, Polygon& polygon) {
    const std::size_t start = place_on_border(from, f);
    std::size_t distance = (place_on_border(to, f) + 8 - start) % 8;
    // Back to the same side: all around the face, or, within the tolerance, just along the side.
    if (distance == 0 && start % 2 == 1 && !ahead(from.sphere, to.sphere, f, start / 2) && holds_centre(f))
      distance = 8;
    for (std::size_t place = start + 1; place < start + distance; ++place)
      if (place % 2 == 0) polygon.push_back(corner_inside(f, (place / 2 + 3) % 4));
  }

  std::uint32_t corner_inside(Face f, std::size_t i) {
    DividedPoint p;
    p.sphere = cube_corner(f, i);
    p.faces = faces_at(p.sphere);
    // Known already, or on the boundary: a point within the tolerance of the corner stands for it.
    for (std::size_t known = 0; known < division_.points.size(); ++known)
      if (point(known).faces == p.faces) return static_cast<std::uint32_t>(known);
    // Central projection: the weight of a corner is the volume that p spans with the two others.
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      p.barycentric[k] = determinant(p.sphere, corner((k + 1) % 3), corner((k + 2) % 3));
      sum += p.barycentric[k];
    }
    for (double& weight : p.barycentric) weight /= sum;
    division_.points.push_back(p);
    return static_cast<std::uint32_t>(division_.points.size() - 1);
  }

  [[nodiscard]] Polygon polygon_of(Face f) {
    std::vector<std::size_t> entries;
    for (std::size_t i = 0; i < boundary_; ++i)
      if (labels_[next(i)] == f && labels_[i] != f) entries.push_back(next(i));
    if (entries.empty()) return whole_face(f);
    Polygon polygon;
    for (std::size_t run = 0; run < entries.size(); ++run) {
      std::size_t i = entries[run];
      for (; labels_[i] == f; i = next(i)) polygon.push_back(static_cast<std::uint32_t>(i));
      polygon.push_back(static_cast<std::uint32_t>(i));
      const DividedPoint leaves = point(i); // copies: corners are appended to the points
      const DividedPoint enters = point(entries[(run + 1) % entries.size()]);
      follow_border(f, leaves, enters, polygon);
    }
    return polygon;
  }

  [[nodiscard]] bool holds_centre(Face f) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (sphere::orientation(corner(k), corner((k + 1) % 3), axis_point(f)) <= 0) return false;
    return true;
  }

  // No edge runs in f: then the triangle holds all of it or nothing.
  [[nodiscard]] Polygon whole_face(Face f) {
    if (!holds_centre(f)) return {};
    Polygon polygon;
    for (std::size_t i = 0; i < 4; ++i) polygon.push_back(corner_inside(f, i));
    return polygon;
  }

  // How far a triangle is from a sliver; negative where it is folded or flat.
  [[nodiscard]] double quality(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    const GridPoint &a = point(i).sphere, &b = point(j).sphere, &c = point(k).sphere;
    if (sphere::orientation(a, b, c) <= 0) return -1;
    const auto edge = [](const GridPoint& p, const GridPoint& q) {
      return squared_norm(Vec3d(q[0] - p[0], q[1] - p[1], q[2] - p[2]));
    };
    return determinant(a, b, c) / std::max({edge(a, b), edge(b, c), edge(c, a)});
  }

  // The triangulation of a convex polygon whose worst triangle is best, by dynamic programming over its chords.
  void triangulate(const Polygon& polygon, Face f) {
    const std::size_t n = polygon.size();
    struct Chord {
      double worst = std::numeric_limits<double>::infinity();
      std::size_t apex = 0;
    };
    std::vector<Chord> chords(n * n);
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) {
        Chord best{-std::numeric_limits<double>::infinity(), 0};
        for (std::size_t k = i + 1; k < i + length; ++k) {
          const double worst = std::min({quality(polygon[i], polygon[k], polygon[i + length]), chords[i * n + k].worst,
                                         chords[k * n + i + length].worst});
          if (worst > best.worst) best = {worst, k};
        }
        chords[i * n + i + length] = best;
      }
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (j - i < 2) continue;
      const std::size_t k = chords[i * n + j].apex;
      division_.pieces.push_back({{polygon[i], polygon[k], polygon[j]}, f});
      open.emplace_back(k, j);
      open.emplace_back(i, k);
    }
  }

  // Every edge of a piece is met by its reverse in another piece, or lies on the boundary, each once.
  void check_edges() const {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::vector<Edge> edges;
    for (const Piece& piece : division_.pieces)
      for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(piece.points[k], piece.points[(k + 1) % 3]);
    for (std::size_t i = 0; i < boundary_; ++i)
      edges.emplace_back(static_cast<std::uint32_t>(next(i)), static_cast<std::uint32_t>(i));
    std::sort(edges.begin(), edges.end());
    if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) refuse();
    for (const auto& [from, to] : edges)
      if (!std::binary_search(edges.begin(), edges.end(), Edge{to, from})) refuse();
  }
};

} // namespace

Division divide(std::vector<DividedPoint> boundary) { return Divider(std::move(boundary)).run(); }

} // namespace orbis::texture
