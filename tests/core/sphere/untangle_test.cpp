#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/mesh/unit_positions.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion_energy.h"
#include "core/sphere/orientation.h"
#include "core/sphere/untangle.h"
#include "support/shapes.h"

using namespace orbis;

namespace {

struct Map {
  explicit Map(int levels) : mesh(shapes::sphere(levels)) {
    for (const Vec3f& p : mesh.positions) points.push_back(normalized(Vec3d(p)));
    stars.build(mesh.triangles, points.size(), pool);
    sphere::compute_references(mesh::unit_positions(mesh), mesh.triangles, 1e-6, pool, references);
  }

  [[nodiscard]] std::size_t folds(const std::vector<Vec3d>& map) const {
    return static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, [&](const mesh::Triangle& t) {
      return !(dot(map[t[0]], cross(map[t[1]] - map[t[0]], map[t[2]] - map[t[0]])) > 0);
    }));
  }
  [[nodiscard]] bool untangle(std::vector<Vec3d>& map) {
    return sphere::untangle({energy, mesh.triangles, stars, references}, points, map, pool);
  }

  mesh::ThreadPool pool{1};
  mesh::TriangleMesh mesh;
  sphere::TriangleEnergy energy = sphere::SymmetricDirichlet{};
  sphere::StarTable stars;
  std::vector<sphere::Reference> references;
  std::vector<Vec3d> points; // without folds
};

// Some vertices thrown about by up to so many edge lengths.
std::vector<Vec3d> thrown_about(const Map& map, std::size_t vertices, double edges, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> within(-1, 1);
  const double edge = norm(map.points[map.mesh.triangles[0][0]] - map.points[map.mesh.triangles[0][1]]);
  std::vector<Vec3d> out = map.points;
  for (std::size_t i = 0; i < vertices; ++i) {
    Vec3d& p = out[random() % out.size()];
    p = normalized(p + edges * edge * Vec3d(within(random), within(random), within(random)));
  }
  return out;
}

} // namespace

TEST_CASE("a map without folds is left alone") {
  Map map(4);
  std::vector<Vec3d> same = map.points;
  CHECK(map.untangle(same));
  CHECK(same == map.points);
}

TEST_CASE("folds here and there are taken out, and what is far from them is not moved") {
  Map map(6);
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::vector<Vec3d> tangled = thrown_about(map, 12, 3, seed);
    const std::vector<Vec3d> start = tangled;
    CHECK(map.folds(tangled) > 0);
    CHECK(map.untangle(tangled));
    CHECK(map.folds(tangled) == 0);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < start.size(); ++v) moved += tangled[v] == start[v] ? 0 : 1;
    CHECK(moved < start.size() / 4);
  }
}

TEST_CASE("what it calls untangled covers the sphere once") {
  Map map(5);
  int untangled = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    std::vector<Vec3d> tangled = thrown_about(map, 4, 10, seed); // far enough to leave vertices that are wound twice
    if (!map.untangle(tangled)) continue;
    ++untangled;
    std::vector<Vec3f> floats;
    for (const Vec3d& p : tangled) floats.push_back(sphere::from_grid(sphere::to_grid(p)));
    CHECK(sphere::certify(floats, map.mesh.triangles).failure() == "");
  }
  CHECK(untangled > 10);
}

TEST_CASE("a map that is tangled all over is given back as such") {
  Map map(4);
  std::vector<Vec3d> tangled = thrown_about(map, map.points.size(), 4, 1);
  CHECK(!map.untangle(tangled));
}
