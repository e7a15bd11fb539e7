// A surface that was cut apart shows no gap on any level.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/lod/bumpy_worlds.h"
#include "core/lod/simplify.h"
#include "core/mesh/edges.h"

using namespace orbis;
using lod_tests::World;

namespace {

// Cuts a world along the plane z = 0, which its triangles do not cross: the southern half gets vertices of its own.
World halved(World world) {
  mesh::TriangleMesh& surface = world.surface;
  const auto before = static_cast<std::uint32_t>(surface.positions.size());
  std::map<mesh::Index, mesh::Index> twin;
  std::vector<bool> is_southern;
  const std::vector<mesh::Triangle> old_triangles = surface.triangles;
  for (mesh::Triangle& t : surface.triangles) {
    bool south = false;
    for (const mesh::Index v : t) south = south || surface.positions[v].z < 0;
    is_southern.push_back(south);
    for (mesh::Index& v : t) {
      if (!south || surface.positions[v].z != 0) continue;
      const auto [entry, is_new] = twin.try_emplace(v, static_cast<mesh::Index>(surface.positions.size()));
      if (is_new) surface.positions.push_back(Vec3f(surface.positions[v]));
      v = entry->second;
    }
  }
  // In the cut: points behind the vertices move up, and those on the plane get a twin in the south.
  const auto added = static_cast<std::uint32_t>(surface.positions.size()) - before;
  texture::CutMesh& cut = world.cut;
  for (texture::CutVertex& v : cut.vertices)
    if (v.point >= before) v.point += added;
  cut.points += added;
  std::map<std::uint32_t, std::uint32_t> twin_point;
  std::map<mesh::Index, mesh::Index> twin_vertex;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    if (!is_southern[cut.parent[t]]) continue;
    for (mesh::Index& v : cut.triangles[t]) {
      texture::CutVertex copy = cut.vertices[v];
      bool on_plane = true;
      for (std::size_t k = 0; k < 3; ++k)
        on_plane = on_plane && (copy.barycentric[k] == 0 || surface.positions[old_triangles[copy.triangle][k]].z == 0);
      if (!on_plane) continue;
      const auto [entry, is_new] = twin_vertex.try_emplace(v, static_cast<mesh::Index>(cut.vertices.size()));
      if (is_new) {
        const auto point = twin_point.try_emplace(copy.point, static_cast<std::uint32_t>(cut.points)).first->second;
        if (const auto known = twin.find(copy.point); known != twin.end()) {
          copy.point = known->second;
        } else {
          copy.point = point;
          if (point == cut.points) ++cut.points;
        }
        // The same place, named from a triangle of the south.
        std::array<double, 3> weights{};
        const mesh::Triangle& own = old_triangles[cut.parent[t]];
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t j = 0; j < 3; ++j)
            if (own[j] == old_triangles[copy.triangle][k]) weights[j] += copy.barycentric[k];
        copy.triangle = cut.parent[t];
        copy.barycentric = weights;
        cut.vertices.push_back(copy);
      }
      v = entry->second;
    }
  }
  return world;
}

using Place = std::array<float, 3>;

// The positions of the points on edges with one triangle, each as often as there are points.
std::multiset<Place> rim_of(const texture::CutMesh& mesh, const std::vector<Vec3f>& positions) {
  std::vector<mesh::Triangle> points;
  std::map<std::uint32_t, Place> at;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    at[mesh.vertices[v].point] = {positions[v].x, positions[v].y, positions[v].z};
  for (const auto& [a, b, c] : mesh.triangles)
    points.push_back({mesh.vertices[a].point, mesh.vertices[b].point, mesh.vertices[c].point});
  std::set<std::uint32_t> rim;
  const mesh::EdgeTable edges(points, mesh.points);
  edges.for_each([&](mesh::Index low, mesh::Index high, std::span<const mesh::EdgeSide> sides) {
    if (sides.size() == 1) rim.insert({low, high});
  });
  std::multiset<Place> out;
  for (const std::uint32_t p : rim) out.insert(at[p]);
  return out;
}

// Whether two of the places that both rims have lie on a short line through p, one on each side.
bool is_on_line(const std::multiset<Place>& rim, const Place& p) {
  const auto vector = [](const Place& q) { return Vec3d{q[0], q[1], q[2]}; };
  for (const Place& a : rim) {
    for (const Place& b : rim) {
      const Vec3d to_a = vector(a) - vector(p), to_b = vector(b) - vector(p);
      const bool is_shared = rim.count(a) == 2 && rim.count(b) == 2 && norm(to_a - to_b) < 0.5;
      if (is_shared && norm(to_a) + norm(to_b) - norm(to_a - to_b) < 1e-6) return true;
    }
  }
  return false;
}

} // namespace

TEST_CASE("both rims of a cut keep the same line on every level that is not too coarse for it") {
  const World world = halved(lod_tests::bumpy_world(4, 12));
  const lod::FullSurface full = world.full();
  NoProgress progress;
  const std::vector<lod::Target> targets{{1200, 0}, {400, 0}, {100, 0}};
  mesh::ThreadPool pool(0);
  const std::vector<lod::Level> levels = lod::simplify(full, targets, pool, progress);
  std::set<Place> before;
  for (const lod::Level& level : levels) {
    CHECK(level.mesh.triangles.size() <= targets[static_cast<std::size_t>(&level - levels.data())].triangles);
    const std::multiset<Place> rim = rim_of(level.mesh, level.positions);
    CHECK(level.concessions.opened == 0);
    for (const Place& place : rim) {
      CHECK(std::abs(place[2]) < 1e-12F);
      if (rim.count(place) != 2) CHECK(is_on_line(rim, place));
      if (!before.empty()) CHECK(before.count(place) == 1);
    }
    before = {rim.begin(), rim.end()};
  }
  CHECK(rim_of(levels.back().mesh, levels.back().positions).size() <
        rim_of(levels.front().mesh, levels.front().positions).size());
}
