// The surface cut at the borders of the cube's faces: crossings once per edge, pieces once per triangle, then vertices
// shared wherever point, face and input vertices agree.
#include <algorithm>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/texture/atlas.h"
#include "core/texture/border_crossings.h"
#include "core/texture/divide.h"
#include "core/texture/unfold.h"

namespace orbis::texture {
namespace {

using mesh::Index;
using mesh::Triangle;
using sphere::GridPoint;

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t report_interval = 1U << 16U;

// The division of the triangles that cross a border, in their order, with the points that it adds.
class Divisions {
public:
  struct Entry {
    std::uint32_t triangle;
    Division division;
  };

  Divisions(std::span<const Triangle> triangles, std::span<const GridPoint> sphere)
      : triangles_(triangles), sphere_(sphere), faces_(sphere.size()) {
    std::transform(sphere.begin(), sphere.end(), faces_.begin(), faces_at);
  }

  // The faces that hold all of a triangle; none where it must be cut.
  [[nodiscard]] FaceMask common_faces(std::uint32_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return static_cast<FaceMask>(faces_[a] & faces_[b] & faces_[c]);
  }

  void divide_triangle(std::uint32_t t) {
    Entry entry{t, divide(boundary_of(t))};
    for (DividedPoint& p : entry.division.points)
      if (p.site == Site::inside) p.point = add({p.sphere, 0, 0});
    entries_.push_back(std::move(entry));
  }

  // Makes every piece positively oriented and fixes the points' places.
  void settle() {
    std::vector<Triangle> pieces;
    for (const Entry& entry : entries_)
      for (const auto& [points, face] : entry.division.pieces)
        pieces.push_back({entry.division.points[points[0]].point, entry.division.points[points[1]].point,
                          entry.division.points[points[2]].point});
    unfold(pieces, sphere_, added_);
    for (Entry& entry : entries_)
      for (DividedPoint& p : entry.division.points)
        if (p.point >= sphere_.size()) p.sphere = added_[p.point - sphere_.size()].sphere;
  }

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::size_t points() const { return sphere_.size() + added_.size(); }

private:
  struct EdgeCrossing {
    std::uint32_t point;
    BorderCrossing crossing;
  };

  std::span<const Triangle> triangles_;
  std::span<const GridPoint> sphere_;
  std::vector<FaceMask> faces_;
  std::vector<AddedPoint> added_;
  std::unordered_map<std::uint64_t, std::vector<EdgeCrossing>> crossings_; // by edge, lower vertex in the upper half
  std::vector<Entry> entries_;

  std::uint32_t add(const AddedPoint& point) {
    added_.push_back(point);
    return static_cast<std::uint32_t>(points() - 1);
  }

  // From the lower to the higher vertex, computed once.
  const std::vector<EdgeCrossing>& crossings(Index low, Index high) {
    const auto [entry, is_new] = crossings_.try_emplace(std::uint64_t{low} << 32U | high);
    if (is_new)
      for (const BorderCrossing& c : border_crossings(sphere_[low], sphere_[high]))
        entry->second.push_back({add({c.sphere, c.from, c.to}), c});
    return entry->second;
  }

  std::vector<DividedPoint> boundary_of(std::uint32_t t) {
    std::vector<DividedPoint> boundary;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = triangles_[t][k], w = triangles_[t][(k + 1) % 3];
      DividedPoint p{v, sphere_[v], faces_[v], {}, static_cast<Site>(k)};
      p.barycentric[k] = 1;
      boundary.push_back(p);
      if ((faces_[v] & faces_[w]) != 0) continue;
      const auto& on_edge = crossings(std::min(v, w), std::max(v, w));
      for (std::size_t i = 0; i < on_edge.size(); ++i) {
        const auto& [point, c] = on_edge[v < w ? i : on_edge.size() - 1 - i];
        p = {point, c.sphere, c.faces, {}, static_cast<Site>(k + 3)};
        p.barycentric[k] = v < w ? 1 - c.t : c.t;
        p.barycentric[(k + 1) % 3] = v < w ? c.t : 1 - c.t;
        boundary.push_back(p);
      }
    }
    return boundary;
  }
};

// Finds the vertex of the result for (point, face, input vertices), or makes it.
class VertexTable {
public:
  VertexTable(CutMesh& mesh, const AtlasLayout& layout, std::size_t input_vertices, std::size_t given_points,
              std::size_t points)
      : mesh_(mesh), layout_(layout), given_points_(given_points), at_input_(input_vertices, none),
        at_added_(points - given_points, none) {}

  // a, b: the input vertices at the ends of the edge that the point lies on (equal at a corner and inside). One input
  // vertex can be two points: where the surface was cut open.
  Index vertex(const CutVertex& v, Face face, Index a, Index b) {
    if (a > b) std::swap(a, b);
    std::uint32_t& first = v.point < given_points_ ? at_input_[a] : at_added_[v.point - given_points_];
    for (std::uint32_t i = first; i != none; i = copies_[i].next)
      if (copies_[i].face == face && copies_[i].a == a && copies_[i].b == b && mesh_.vertices[i].point == v.point)
        return i;
    const auto made = static_cast<Index>(mesh_.vertices.size());
    mesh_.vertices.push_back(v);
    mesh_.vertices.back().uv = uv_of(v.sphere, face);
    copies_.push_back({first, a, b, face});
    first = made;
    return made;
  }

private:
  // The vertices of one input vertex, or of one added point, form a chain: it has one link per face as a rule.
  struct Copy {
    std::uint32_t next;
    Index a, b;
    Face face;
  };
  CutMesh& mesh_;
  const AtlasLayout& layout_;
  std::size_t given_points_;
  std::vector<std::uint32_t> at_input_, at_added_;
  std::vector<Copy> copies_;

  [[nodiscard]] Vec2f uv_of(const GridPoint& p, Face face) const {
    const auto [x, y] = layout_.texel_of(face, project(p, face));
    return {static_cast<float>(x / layout_.width), static_cast<float>(y / layout_.height)};
  }
};

class Writer {
public:
  Writer(std::span<const Triangle> triangles, std::span<const Triangle> corners, std::span<const GridPoint> sphere,
         const AtlasLayout& layout, const Divisions& divisions)
      : triangles_(triangles), corners_(corners), sphere_(sphere),
        table_(mesh_, layout, input_vertices(corners), sphere.size(), divisions.points()) {
    mesh_.points = divisions.points();
    mesh_.cut_triangles = divisions.entries().size();
    const std::size_t expected = triangles.size() + 4 * divisions.entries().size();
    mesh_.vertices.reserve(at_least_one_per(corners) + 4 * divisions.entries().size());
    mesh_.triangles.reserve(expected);
    mesh_.parent.reserve(expected);
    mesh_.face.reserve(expected);
  }

  void whole(std::uint32_t t, Face face) {
    Triangle vertices{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index point = triangles_[t][k], input = corners_[t][k];
      CutVertex v{t, {}, sphere_[point], {}, point};
      v.barycentric[k] = 1;
      vertices[k] = table_.vertex(v, face, input, input);
    }
    append(vertices, t, face);
  }

  void pieces(const Divisions::Entry& entry) {
    for (const auto& [points, face] : entry.division.pieces) {
      Triangle vertices{};
      for (std::size_t k = 0; k < 3; ++k) {
        const DividedPoint& p = entry.division.points[points[k]];
        const auto [a, b] = input_edge(entry.triangle, p.site);
        vertices[k] = table_.vertex({entry.triangle, p.barycentric, p.sphere, {}, p.point}, face, a, b);
      }
      append(vertices, entry.triangle, face);
    }
  }

  CutMesh take() { return std::move(mesh_); }

private:
  std::span<const Triangle> triangles_, corners_;
  std::span<const GridPoint> sphere_;
  CutMesh mesh_;
  VertexTable table_;

  static std::size_t input_vertices(std::span<const Triangle> corners) {
    Index highest = 0;
    for (const Triangle& t : corners) highest = std::max({highest, t[0], t[1], t[2]});
    return std::size_t{highest} + 1;
  }
  static std::size_t at_least_one_per(std::span<const Triangle> corners) {
    return std::min(input_vertices(corners), 3 * corners.size());
  }

  [[nodiscard]] std::pair<Index, Index> input_edge(std::uint32_t t, Site site) const {
    const auto k = static_cast<std::size_t>(site);
    if (site == Site::inside) return {corners_[t][0], corners_[t][0]};
    if (site < Site::edge_01) return {corners_[t][k], corners_[t][k]};
    return {corners_[t][k - 3], corners_[t][(k - 2) % 3]};
  }

  void append(const Triangle& vertices, std::uint32_t parent, Face face) {
    mesh_.triangles.push_back(vertices);
    mesh_.parent.push_back(parent);
    mesh_.face.push_back(face);
  }
};

// Within the tolerance of a border a triangle may lie in several faces: the one its corners lie deepest in.
Face deepest_face(FaceMask faces, const Triangle& t, std::span<const GridPoint> sphere) {
  Face best = face_count;
  std::int64_t depth = 0;
  for (Face f = 0; f < face_count; ++f) {
    if ((faces & bit_of(f)) == 0) continue;
    const std::int64_t sum = std::int64_t{along(sphere[t[0]], f)} + along(sphere[t[1]], f) + along(sphere[t[2]], f);
    if (best == face_count || sum > depth) {
      best = f;
      depth = sum;
    }
  }
  return best;
}

} // namespace

CutMesh cut(std::span<const Triangle> triangles, std::span<const Triangle> corners, std::span<const GridPoint> sphere,
            const AtlasLayout& layout, Progress& progress) {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  const auto step = [&](std::uint32_t t, std::uint64_t done) {
    if (t % report_interval != 0) return;
    progress.check();
    progress.report(Stage::atlas, done, 2 * std::uint64_t{count});
  };

  Divisions divisions(triangles, sphere);
  for (std::uint32_t t = 0; t < count; ++t) {
    step(t, t);
    if (divisions.common_faces(t) == 0) divisions.divide_triangle(t);
  }
  divisions.settle();

  Writer writer(triangles, corners, sphere, layout, divisions);
  auto entry = divisions.entries().begin();
  for (std::uint32_t t = 0; t < count; ++t) {
    step(t, std::uint64_t{count} + t);
    if (const FaceMask faces = divisions.common_faces(t); faces != 0)
      writer.whole(t, deepest_face(faces, triangles[t], sphere));
    else
      writer.pieces(*entry++);
  }
  progress.report(Stage::atlas, 2 * std::uint64_t{count}, 2 * std::uint64_t{count});
  return writer.take();
}

} // namespace orbis::texture
