// The surface cut at the borders of the cube's faces: crossings once per edge, pieces once per triangle, then vertices
// shared wherever point, chart and input vertices agree.
#include "core/texture/cut.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <utility>

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

// The charts: one for each face that is used, numbered as they are met.
class ChartTable {
public:
  std::uint32_t chart(Face face, std::vector<Chart>& charts) {
    if (number_[face] == none) {
      number_[face] = static_cast<std::uint32_t>(charts.size());
      charts.emplace_back();
    }
    return number_[face];
  }

private:
  std::array<std::uint32_t, face_count> number_{none, none, none, none, none, none};
};

// Finds the vertex of the result for (point, face, input vertices), or makes it.
class VertexTable {
public:
  VertexTable(CutMesh& mesh, std::size_t input_vertices, std::size_t given_points, std::size_t points)
      : mesh_(mesh), given_points_(given_points), at_input_(input_vertices, none),
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
    copies_.push_back({first, a, b, face});
    first = made;
    return made;
  }

  [[nodiscard]] Face face_of_copy(std::size_t v) const { return copies_[v].face; }

private:
  // The vertices of one input vertex, or of one added point, form a chain: it has one link per face as a rule.
  struct Copy {
    std::uint32_t next;
    Index a, b;
    Face face;
  };
  CutMesh& mesh_;
  std::size_t given_points_;
  std::vector<std::uint32_t> at_input_, at_added_;
  std::vector<Copy> copies_;
};

// Lays the vertices into the squares of their faces.
class Flattener {
public:
  Flattener(FlatCharts& charts, const VertexTable& table)
      : charts_(charts), table_(table), faces_(charts.mesh.points), first_(charts.mesh.points, none) {}

  void run() {
    const std::vector<CutVertex>& vertices = charts_.mesh.vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      FaceMask& faces = faces_[vertices[v].point];
      faces = static_cast<FaceMask>(faces | bit_of(table_.face_of_copy(v)));
    }
    for (std::size_t v = 0; v < vertices.size(); ++v)
      charts_.place_of.push_back(place(vertices[v], table_.face_of_copy(v)));
    for (std::size_t t = 0; t < charts_.mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = charts_.mesh.triangles[t];
      charts_.triangles.push_back({charts_.place_of[a], charts_.place_of[b], charts_.place_of[c]});
      for (const Index p : charts_.triangles.back()) charts_.places[p].chart = charts_.mesh.chart[t];
    }
  }

private:
  FlatCharts& charts_;
  const VertexTable& table_;
  std::vector<FaceMask> faces_;      // point -> the faces it has copies in
  std::vector<std::uint32_t> first_; // point -> its first place; the others follow in a chain
  std::vector<std::uint32_t> next_;
  std::vector<Face> face_;

  std::uint32_t place(const CutVertex& v, Face face) {
    for (std::uint32_t i = first_[v.point]; i != none; i = next_[i])
      if (face_[i] == face) return i;
    const auto made = static_cast<std::uint32_t>(charts_.places.size());
    charts_.places.push_back(flat(v, face));
    next_.push_back(std::exchange(first_[v.point], made));
    face_.push_back(face);
    return made;
  }

  // A point that several faces have lies on the border between them, exactly.
  [[nodiscard]] FlatPlace flat(const CutVertex& v, Face face) const {
    const FacePoint p = project(v.sphere, face);
    FlatPlace place{{0.5 * (p.u + 1), 0.5 * (p.v + 1)}, false, false, 0};
    const auto fix = [&](Face side, double& coordinate, double value, bool& fixed) {
      if ((faces_[v.point] & bit_of(side)) == 0) return;
      coordinate = value;
      fixed = true;
    };
    fix(opposite(face_right[face]), place.at.x, 0, place.fixed_x);
    fix(face_right[face], place.at.x, 1, place.fixed_x);
    fix(opposite(face_down[face]), place.at.y, 0, place.fixed_y);
    fix(face_down[face], place.at.y, 1, place.fixed_y);
    return place;
  }
};

class Writer {
public:
  Writer(const AtlasComponent& component, const Divisions& divisions)
      : component_(component), corners_(all_corners(component)),
        table_(mesh_, input_vertices(corners_), component.sphere.size(), divisions.points()) {
    mesh_.points = divisions.points();
    mesh_.cut_triangles = divisions.entries().size();
    const std::size_t expected = component.triangles.size() + 4 * divisions.entries().size();
    mesh_.vertices.reserve(at_least_one_per(corners_) + 4 * divisions.entries().size());
    mesh_.triangles.reserve(expected);
    mesh_.parent.reserve(expected);
    mesh_.chart.reserve(expected);
  }

  void whole(std::uint32_t t, Face face) {
    Triangle vertices{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index point = component_.triangles[t][k], input = corners_[t][k];
      CutVertex v{t, {}, component_.sphere[point], {}, point};
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

  FlatCharts take() {
    FlatCharts out;
    out.mesh = std::move(mesh_);
    Flattener(out, table_).run();
    return out;
  }

private:
  const AtlasComponent& component_;
  std::vector<Triangle> corners_;
  CutMesh mesh_;
  ChartTable charts_;
  VertexTable table_;

  // Triangles that only close holes have no input vertices: their own ones stand for them, numbered behind.
  static std::vector<Triangle> all_corners(const AtlasComponent& component) {
    std::vector<Triangle> corners(component.corners.begin(), component.corners.end());
    const auto first = static_cast<Index>(input_vertices(corners));
    for (std::size_t t = corners.size(); t < component.triangles.size(); ++t) {
      const auto& [a, b, c] = component.triangles[t];
      corners.push_back({first + a, first + b, first + c});
    }
    return corners;
  }
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
    const Triangle& corners = corners_[t];
    if (site == Site::inside) return {corners[0], corners[0]};
    if (site < Site::edge_01) return {corners[k], corners[k]};
    return {corners[k - 3], corners[(k - 2) % 3]};
  }

  void append(const Triangle& vertices, std::uint32_t parent, Face face) {
    mesh_.triangles.push_back(vertices);
    mesh_.parent.push_back(parent);
    mesh_.chart.push_back(charts_.chart(face, mesh_.charts));
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

FlatCharts cut(const AtlasComponent& component, Progress& progress) {
  const auto count = static_cast<std::uint32_t>(component.triangles.size());
  const auto step = [&](std::uint32_t t, std::uint64_t done) {
    if (t % report_interval != 0) return;
    progress.check();
    progress.report(Stage::atlas, done, 2 * std::uint64_t{count});
  };

  Divisions divisions(component.triangles, component.sphere);
  for (std::uint32_t t = 0; t < count; ++t) {
    step(t, t);
    if (divisions.common_faces(t) == 0) divisions.divide_triangle(t);
  }
  divisions.settle();

  Writer writer(component, divisions);
  auto entry = divisions.entries().begin();
  for (std::uint32_t t = 0; t < count; ++t) {
    step(t, std::uint64_t{count} + t);
    if (const FaceMask faces = divisions.common_faces(t); faces != 0)
      writer.whole(t, deepest_face(faces, component.triangles[t], component.sphere));
    else
      writer.pieces(*entry++);
  }
  return writer.take();
}

} // namespace orbis::texture
