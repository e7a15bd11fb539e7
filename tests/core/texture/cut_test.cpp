#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "atlas_of.h"
#include "core/sphere/certificate.h"
#include "core/texture/atlas.h"
#include "sphere_meshes.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

CutMesh cut_mesh(const SphereMesh& mesh, const std::vector<Triangle>& corners) { return atlas_of(mesh, corners, 1024); }
CutMesh cut_mesh(const SphereMesh& mesh) { return cut_mesh(mesh, mesh.triangles); }

Vec3d as_vector(const GridPoint& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

// The cut mesh welded by grid point.
struct WeldedCut {
  std::vector<Vec3f> points;
  std::vector<Triangle> triangles;
};
WeldedCut weld_by_sphere(const CutMesh& mesh) {
  std::map<GridPoint, Index> known;
  WeldedCut welded;
  std::vector<Index> vertex_of;
  for (const CutVertex& v : mesh.vertices) {
    const auto [entry, is_new] = known.try_emplace(v.sphere, static_cast<Index>(welded.points.size()));
    if (is_new) welded.points.push_back(sphere::from_grid(v.sphere));
    vertex_of.push_back(entry->second);
  }
  for (const Triangle& t : mesh.triangles)
    welded.triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
  return welded;
}

void check_surface(const CutMesh& mesh) {
  const WeldedCut welded = weld_by_sphere(mesh);
  const auto certificate = sphere::certify(welded.points, welded.triangles);
  CHECK_MESSAGE(certificate.valid, certificate.failure());
  CHECK(certificate.euler_characteristic == 2);
  CHECK(mesh.points == welded.points.size());
  for (const Triangle& t : mesh.triangles)
    CHECK(sphere::orientation(mesh.vertices[t[0]].sphere, mesh.vertices[t[1]].sphere, mesh.vertices[t[2]].sphere) == 1);
}

// A vertex's weights, on whatever triangle it was recorded, carried over to triangle t.
std::array<double, 3> weights_on(const SphereMesh& mesh, const CutVertex& v, std::uint32_t t) {
  std::array<double, 3> weights{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (mesh.triangles[t][k] == mesh.triangles[v.triangle][i]) weights[k] = v.barycentric[i];
  return weights;
}

void check_weights(const SphereMesh& mesh, const CutMesh& result) {
  const auto grid = mesh.grid();
  for (const CutVertex& v : result.vertices) {
    const auto& corners = mesh.triangles[v.triangle];
    Vec3d sum;
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(v.barycentric[k] >= 0);
      sum += as_vector(grid[corners[k]]) * v.barycentric[k];
    }
    const Vec3d expected = normalized(sum), found = normalized(as_vector(v.sphere));
    CHECK(norm(expected - found) < 1e-6);
    CHECK(std::accumulate(v.barycentric.begin(), v.barycentric.end(), 0.0) == doctest::Approx(1).epsilon(1e-14));
    if (v.point < mesh.points.size()) CHECK(v.sphere == grid[v.point]);
  }
}

// The pieces of a triangle fill it: their areas in barycentric coordinates add up to 1.
void check_areas(const SphereMesh& mesh, const CutMesh& result) {
  std::vector<double> area(mesh.triangles.size());
  for (std::size_t i = 0; i < result.triangles.size(); ++i) {
    std::array<std::array<double, 3>, 3> w{};
    for (std::size_t k = 0; k < 3; ++k)
      w[k] = weights_on(mesh, result.vertices[result.triangles[i][k]], result.parent[i]);
    const double det = w[0][0] * (w[1][1] * w[2][2] - w[1][2] * w[2][1]) -
                       w[0][1] * (w[1][0] * w[2][2] - w[1][2] * w[2][0]) +
                       w[0][2] * (w[1][0] * w[2][1] - w[1][1] * w[2][0]);
    area[result.parent[i]] += det;
  }
  for (const double a : area) CHECK(a == doctest::Approx(1).epsilon(1e-9));
}

// Triangles keep their orientation in the atlas and stay in their charts.
void check_uv(const CutMesh& result) {
  for (std::size_t i = 0; i < result.triangles.size(); ++i) {
    const Chart& chart = result.charts[result.chart[i]];
    const auto corners = in_page(result, i);
    const double area = (corners[1].y - corners[0].y) * (corners[2].x - corners[0].x) -
                        (corners[1].x - corners[0].x) * (corners[2].y - corners[0].y);
    CHECK(area > 0);
    for (const RasterPoint& p : corners) {
      CHECK(p.x >= chart.x - 1e-3);
      CHECK(p.y >= chart.y - 1e-3);
      CHECK(p.x <= chart.x + chart.width + 1e-3);
      CHECK(p.y <= chart.y + chart.height + 1e-3);
    }
  }
}

void check_all(const SphereMesh& mesh) {
  REQUIRE(mesh.positive());
  const CutMesh result = cut_mesh(mesh);
  check_surface(result);
  check_weights(mesh, result);
  check_areas(mesh, result);
  check_uv(result);
}

} // namespace

TEST_CASE("regular solids, aligned with the cube, are cut into a closed surface") {
  for (const SphereMesh& solid : {tetrahedron(), octahedron(), icosahedron(), cube()})
    for (int level = 0; level < 5; ++level) {
      CAPTURE(solid.points.size());
      CAPTURE(level);
      check_all(subdivided(solid, level));
    }
}

TEST_CASE("regular solids, turned at random, are cut into a closed surface") {
  std::mt19937 random(1);
  for (int round = 0; round < 40; ++round)
    for (const SphereMesh& solid : {tetrahedron(), octahedron(), icosahedron(), cube()}) {
      CAPTURE(round);
      CAPTURE(solid.points.size());
      check_all(turned(subdivided(solid, round % 4), random));
    }
}

TEST_CASE("irregular triangles of every size are cut into a closed surface") {
  std::mt19937 random(2);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    const double fraction = std::pow(0.5, round % 6);
    check_all(turned(
        jittered(subdivided(round % 2 == 0 ? tetrahedron() : icosahedron(), 1 + round % 4), fraction, random), random));
  }
}
