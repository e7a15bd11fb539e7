#include "core/lod/chart_map.h"

#include "core/mesh/edges.h"

namespace orbis::lod {
namespace {

constexpr int most_steps = 4096; // of a walk; the longest on a scan of 100,000 triangles take some hundreds

// Twice the area of (a, b, u).
double turn(const Vec2f& a, const Vec2f& b, const Uv& u) {
  return (double{b.x} - a.x) * (u[1] - a.y) - (u[0] - a.x) * (double{b.y} - a.y);
}

} // namespace

ChartMap::ChartMap(const texture::CutMesh& mesh, std::span<const std::uint32_t> region) : mesh_(mesh) {
  neighbours_.assign(mesh.triangles.size(), {none, none, none});
  std::vector<mesh::Triangle> points;
  points.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    points.push_back({mesh.vertices[a].point, mesh.vertices[b].point, mesh.vertices[c].point});
  const auto uv_at = [&](std::uint32_t t, std::size_t k) { return mesh.vertices[mesh.triangles[t][k % 3]].uv; };
  const mesh::EdgeTable edges(points, mesh.points);
  edges.for_each([&](mesh::Index, mesh::Index, std::span<const mesh::EdgeSide> sides) {
    if (sides.size() != 2) return;
    const std::uint32_t s = sides[0].half_edge / 3, t = sides[1].half_edge / 3;
    const std::size_t i = sides[0].half_edge % 3, j = sides[1].half_edge % 3;
    if (region[s] != region[t] || uv_at(s, i) != uv_at(t, j + 1) || uv_at(s, i + 1) != uv_at(t, j)) return;
    neighbours_[s][i] = t;
    neighbours_[t][j] = s;
  });
}

std::optional<Place> ChartMap::locate(const Uv& uv, std::uint32_t from) const {
  std::uint32_t t = from;
  for (int step = 0; step < most_steps; ++step) {
    const mesh::Triangle& corners = mesh_.triangles[t];
    std::array<double, 3> turns{}; // edge k from corner k to k + 1: the weight of corner k + 2
    double whole = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      turns[k] = turn(mesh_.vertices[corners[k]].uv, mesh_.vertices[corners[(k + 1) % 3]].uv, uv);
      whole += turns[k];
    }
    // v points down in the atlas, so that charts may run either way around.
    const double sign = whole < 0 ? -1 : 1;
    // Out through the edge that the place is farthest behind; along the border if there is nothing behind that.
    std::size_t out = 3;
    bool is_inside = whole != 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (sign * turns[k] >= 0) continue;
      is_inside = false;
      if (neighbours_[t][k] != none && (out == 3 || sign * turns[k] < sign * turns[out])) out = k;
    }
    if (is_inside) return Place{t, {turns[1] / whole, turns[2] / whole, turns[0] / whole}};
    if (out == 3) return std::nullopt;
    t = neighbours_[t][out];
  }
  return std::nullopt;
}

} // namespace orbis::lod
