// The surface cut at the borders of the cube's faces: crossings once per edge, pieces once per triangle.
#include "core/texture/cut.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/texture/border_crossings.h"
#include "core/texture/cut_writer.h"
#include "core/texture/divide.h"
#include "core/texture/unfold.h"

namespace orbis::texture {
namespace {

using mesh::Index;
using mesh::Triangle;
using sphere::GridPoint;

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

// Lays the places into the squares of their faces. A point that several faces have lies on the border between them,
// exactly.
void lay_into_squares(WrittenCharts& written) {
  const CutMesh& mesh = written.charts.mesh;
  std::vector<FaceMask> faces(mesh.points); // point -> the faces it has places in
  for (std::size_t p = 0; p < written.vertex.size(); ++p) {
    FaceMask& at = faces[mesh.vertices[written.vertex[p]].point];
    at = static_cast<FaceMask>(at | bit_of(written.face[p]));
  }
  for (std::size_t p = 0; p < written.vertex.size(); ++p) {
    const CutVertex& v = mesh.vertices[written.vertex[p]];
    const Face face = written.face[p];
    FlatPlace& place = written.charts.places[p];
    const FacePoint projected = project(v.sphere, face);
    place.at = {0.5 * (projected.u + 1), 0.5 * (projected.v + 1)};
    const auto fix = [&](Face side, double& coordinate, double value, bool& fixed) {
      if ((faces[v.point] & bit_of(side)) == 0) return;
      coordinate = value;
      fixed = true;
    };
    fix(opposite(face_right[face]), place.at.x, 0, place.fixed_x);
    fix(face_right[face], place.at.x, 1, place.fixed_x);
    fix(opposite(face_down[face]), place.at.y, 0, place.fixed_y);
    fix(face_down[face], place.at.y, 1, place.fixed_y);
  }
}

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

  CutWriter writer(component, divisions.points(), divisions.entries().size());
  auto entry = divisions.entries().begin();
  for (std::uint32_t t = 0; t < count; ++t) {
    step(t, std::uint64_t{count} + t);
    if (const FaceMask faces = divisions.common_faces(t); faces != 0)
      writer.whole(t, deepest_face(faces, component.triangles[t], component.sphere));
    else
      writer.pieces(t, (entry++)->division);
  }
  WrittenCharts written = writer.take();
  lay_into_squares(written);
  return std::move(written.charts);
}

} // namespace orbis::texture
