#include "core/steps/snap_and_cut.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/sphere/snap.h"
#include "core/steps/placement.h"

namespace orbis {
namespace {

constexpr int most_turns = 8;
constexpr double turn_angle = 0.02; // radians: about a hundred texels of a usual atlas

// Rodrigues' rotation about an axis that is in no special position to the cube.
Vec3d turned(const Vec3d& p, double angle) {
  const Vec3d axis = normalized(Vec3d{0.35, 0.57, 0.74});
  const double c = std::cos(angle), s = std::sin(angle);
  return c * p + s * cross(axis, p) + (1 - c) * dot(axis, p) * axis;
}

// One component, with numbers of its own.
struct CutComponent {
  std::vector<sphere::GridPoint> points;
  texture::CutMesh cut;
  int turns = 0;
};

CutComponent snap_and_cut_one(const Surface& surface, const Component& c, std::span<const Vec3d> points,
                              const texture::AtlasLayout& layout, Progress& progress) {
  const mesh::TriangleMesh mesh = mesh_of(surface, c);
  const auto delivered = std::span(mesh.triangles).first(c.input_triangles);
  const auto corners = std::span(surface.corners).subspan(c.first_triangle, c.input_triangles);
  std::string failure;
  std::vector<Vec3d> rotated(points.begin(), points.end());
  for (int turn = 0; turn < most_turns; ++turn) {
    for (std::size_t v = 0; turn > 0 && v < points.size(); ++v) rotated[v] = turned(points[v], turn * turn_angle);
    sphere::Snapped snapped = sphere::snap(rotated, mesh.triangles);
    if (snapped.folded > 0) {
      failure = std::to_string(snapped.folded) + " triangles are too small for the numbers of the result";
      continue;
    }
    try {
      texture::CutMesh cut = texture::cut(delivered, corners, snapped.points, layout, progress);
      return {std::move(snapped.points), std::move(cut), turn};
    } catch (const Error& e) {
      if (e.code() != ErrorCode::not_certified) throw;
      failure = e.message();
    }
  }
  throw Error(ErrorCode::not_certified, "the map could not be delivered without a fold: " + failure);
}

// Appends a component's cut mesh, with the surface's numbers for its own. Added points are numbered behind all vertices
// of the surface.
void append(const Surface& surface, const Component& c, const texture::CutMesh& part, texture::CutMesh& out) {
  const auto first = static_cast<mesh::Index>(out.vertices.size());
  const auto added = static_cast<std::uint32_t>(std::max<std::uint64_t>(out.points, surface.mesh.positions.size()));
  for (texture::CutVertex v : part.vertices) {
    v.triangle += c.first_triangle;
    v.point = v.point < c.vertices ? v.point + c.first_vertex : v.point - c.vertices + added;
    out.vertices.push_back(v);
  }
  for (const auto& [i, j, k] : part.triangles) out.triangles.push_back({first + i, first + j, first + k});
  for (const std::uint32_t t : part.parent) out.parent.push_back(c.first_triangle + t);
  out.face.insert(out.face.end(), part.face.begin(), part.face.end());
  out.cut_triangles += part.cut_triangles;
  out.points = added + part.points - c.vertices;
}

} // namespace

CutSphere snap_and_cut(const Surface& surface, std::span<const Vec3d> points, const texture::AtlasLayout& layout,
                       Progress& progress, Report& report) {
  CutSphere out;
  const CellGrid grid = cells_for(surface.components.size());
  for (std::size_t i = 0; i < surface.components.size(); ++i) {
    const Component& c = surface.components[i];
    progress.check();
    NoProgress quiet;
    CutComponent one = snap_and_cut_one(surface, c, points.subspan(c.first_vertex, c.vertices), layout,
                                        surface.components.size() == 1 ? progress : quiet);
    for (texture::CutVertex& v : one.cut.vertices) v.uv = grid.place(i, v.uv);
    append(surface, c, one.cut, out.cut);
    out.points.insert(out.points.end(), one.points.begin(), one.points.end());
    if (one.turns > 0) {
      report.notes.push_back({"turned-sphere",
                              "the sphere was turned by " + std::to_string(one.turns * turn_angle) +
                                  " radians to keep every triangle resolvable",
                              "/meshes/" + std::to_string(c.mesh)});
    }
  }
  progress.report(Stage::atlas, 1, 1);
  return out;
}

} // namespace orbis
