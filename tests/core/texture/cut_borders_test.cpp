// What the cut does on and beside the borders of the cube's faces, where rounding decides.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "atlas_of.h"
#include "core/sphere/certificate.h"
#include "core/texture/atlas.h"
#include "core/texture/border_crossings.h"
#include "core/texture/cut.h"
#include "core/texture/unfold.h"
#include "sphere_meshes.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

CutMesh cut_mesh(const SphereMesh& mesh, const std::vector<Triangle>& corners) {
  const std::vector<GridPoint> grid = mesh.grid();
  const std::vector<Vec3f> positions(grid.size());
  NoProgress progress;
  return cut({mesh.triangles, corners, grid, positions, mesh.triangles.size()}, progress).mesh;
}

bool is_sphere(const CutMesh& mesh) {
  std::map<GridPoint, Index> known;
  std::vector<Vec3f> points;
  std::vector<Index> vertex_of;
  for (const CutVertex& v : mesh.vertices) {
    const auto [entry, is_new] = known.try_emplace(v.sphere, static_cast<Index>(points.size()));
    if (is_new) points.push_back(sphere::from_grid(v.sphere));
    vertex_of.push_back(entry->second);
  }
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({vertex_of[a], vertex_of[b], vertex_of[c]});
  return sphere::certify(points, triangles).valid;
}

// Moves most vertices to about the nearest plane between two faces, some exactly, some a little off, where no triangle
// folds.
SphereMesh pulled_to_borders(SphereMesh mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  for (Vec3d& p : mesh.points) {
    if (unit(random) < 0.3) continue;
    const double off = std::pow(10.0, -3 - 5 * unit(random)) * (unit(random) - 0.5);
    const Vec3d before = p;
    std::array<double*, 3> x{&p.x, &p.y, &p.z};
    std::shuffle(x.begin(), x.end(), random);
    const double mean = (std::abs(*x[0]) + std::abs(*x[1])) / 2;
    *x[0] = std::copysign(mean, *x[0]);
    *x[1] = std::copysign(mean * (1 + off), *x[1]);
    p = normalized(p);
    if (!mesh.positive()) p = before;
  }
  return mesh;
}

// The triangle that holds p split into three, unless one of them would fold.
SphereMesh with_point(SphereMesh mesh, const Vec3d& p) {
  const auto left_of = [&](Index a, Index b) {
    return sphere::orientation(sphere::to_grid(mesh.points[a]), sphere::to_grid(mesh.points[b]), sphere::to_grid(p)) ==
           1;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    if (!left_of(a, b) || !left_of(b, c) || !left_of(c, a)) continue;
    const auto v = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(p);
    mesh.triangles[t] = {a, b, v};
    mesh.triangles.push_back({b, c, v});
    mesh.triangles.push_back({c, a, v});
    break;
  }
  return mesh;
}

} // namespace

TEST_CASE("vertices on a border and just beside it give a closed surface, or a clean refusal that a turn cures") {
  std::mt19937 random(21);
  int closed = 0;
  for (int round = 0; round < 150; ++round) {
    CAPTURE(round);
    const SphereMesh base = round % 3 == 0 ? tetrahedron() : round % 3 == 1 ? icosahedron() : cube();
    const SphereMesh mesh = pulled_to_borders(subdivided(base, round % 4), random);
    try {
      const CutMesh result = cut_mesh(mesh, mesh.triangles);
      CHECK(is_sphere(result));
      ++closed;
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::not_certified);
      const SphereMesh again = turned(mesh, random);
      CHECK(is_sphere(cut_mesh(again, again.triangles)));
    }
  }
  CHECK(closed > 140);
}

// As the pipeline does: one turn after the other, among those that the grid holds without a fold.
bool a_turn_cures(const SphereMesh& mesh, std::mt19937& random) {
  for (int turn = 0; turn < 20; ++turn) {
    const SphereMesh again = turned(mesh, random);
    if (!again.positive()) continue;
    try {
      return is_sphere(atlas_of(again, 512));
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::not_certified);
    }
  }
  return false;
}

TEST_CASE("vertices on a border and just beside it give an atlas, or a clean refusal that a turn cures") {
  std::mt19937 random(26);
  int made = 0;
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    const SphereMesh base = round % 3 == 0 ? tetrahedron() : round % 3 == 1 ? icosahedron() : cube();
    const SphereMesh mesh = pulled_to_borders(subdivided(base, round % 4), random);
    try {
      CHECK(is_sphere(atlas_of(mesh, 512)));
      ++made;
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::not_certified);
      CHECK(a_turn_cures(mesh, random));
    }
  }
  CHECK(made > 40);
}

TEST_CASE("triangles that get smaller and smaller towards a corner of the cube, or a border, are cut, too") {
  std::mt19937 random(22);
  int closed = 0, rounds = 0;
  for (const Vec3d& target : {Vec3d(1, 1, 1), Vec3d(-1, 1, -1), Vec3d(1, 1, 0.2), Vec3d(0.3, -1, 1)})
    for (int round = 0; round < 10; ++round, ++rounds) {
      CAPTURE(rounds);
      SphereMesh mesh = turned(icosahedron(), random);
      const double closest = round < 5 ? 1e-5 : 1e-7; // beyond the tolerance, and far below it
      for (double distance = 0.3; distance > closest; distance *= 0.5)
        mesh = with_point(mesh, normalized(normalized(target) + random_vector(random) * distance));
      CHECK(mesh.triangles.size() > 40);
      try {
        const CutMesh result = cut_mesh(mesh, mesh.triangles);
        CHECK(is_sphere(result));
        ++closed;
      } catch (const Error& e) {
        CHECK(e.code() == ErrorCode::not_certified);
      }
    }
  CHECK(closed > rounds - 4);
}

TEST_CASE("crossings lie exactly on a border, in order, and each part of an edge lies in one face") {
  std::mt19937 random(23);
  const auto point = [&] { return sphere::to_grid(normalized(random_vector(random))); };
  std::size_t found = 0;
  for (int round = 0; round < 2000; ++round) {
    const GridPoint a = point(), b = point();
    const auto crossings = border_crossings(a, b);
    FaceMask here = faces_at(a);
    double t = 0;
    for (const BorderCrossing& c : crossings) {
      CHECK(along(c.sphere, c.from) == along(c.sphere, c.to));
      CHECK((c.faces & bit_of(c.from)) != 0);
      CHECK((c.faces & bit_of(c.to)) != 0);
      CHECK((here & c.faces) != 0);
      CHECK(c.t > t);
      CHECK(c.t < 1);
      here = c.faces;
      t = c.t;
      ++found;
    }
    CHECK((here & faces_at(b)) != 0);
  }
  CHECK(found > 2000);
}

TEST_CASE("output vertices are shared where point, chart and input vertices agree, and only there") {
  std::mt19937 random(24);
  const SphereMesh mesh = turned(subdivided(icosahedron(), 2), random);
  const CutMesh welded = cut_mesh(mesh, mesh.triangles);
  // One vertex per point and chart.
  std::set<std::tuple<std::uint32_t, std::uint32_t, Index>> copies; // point, chart, vertex
  for (std::size_t i = 0; i < welded.triangles.size(); ++i)
    for (const Index v : welded.triangles[i]) copies.emplace(welded.vertices[v].point, welded.chart[i], v);
  CHECK(copies.size() == welded.vertices.size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> places;
  for (const auto& [p, chart, v] : copies) places.emplace(p, chart);
  CHECK(places.size() == copies.size());

  // Every triangle with its own three input vertices: nothing is shared between triangles.
  std::vector<Triangle> corners;
  for (Index t = 0; t < mesh.triangles.size(); ++t) corners.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  const CutMesh split = cut_mesh(mesh, corners);
  CHECK(split.points == welded.points);
  CHECK(split.triangles.size() == welded.triangles.size());
  CHECK(is_sphere(split));
  std::map<Index, std::uint32_t> parent_of;
  for (std::size_t i = 0; i < split.triangles.size(); ++i)
    for (const Index v : split.triangles[i]) {
      const auto [entry, is_new] = parent_of.try_emplace(v, split.parent[i]);
      CHECK(entry->second == split.parent[i]);
      CHECK(split.vertices[v].triangle == split.parent[i]);
    }
}

TEST_CASE(
    "two triangles give a crossing on their edge the same place and weights, whichever input vertices they have") {
  std::mt19937 random(25);
  const SphereMesh mesh = turned(subdivided(tetrahedron(), 1), random);
  std::vector<Triangle> corners;
  for (Index t = 0; t < mesh.triangles.size(); ++t) corners.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  std::map<std::uint32_t, std::set<std::tuple<GridPoint, double, double>>> seen; // by point
  for (const CutVertex& v : cut_mesh(mesh, corners).vertices) {
    std::vector<std::pair<Index, double>> weights;
    for (std::size_t k = 0; k < 3; ++k)
      if (v.barycentric[k] != 0) weights.emplace_back(mesh.triangles[v.triangle][k], v.barycentric[k]);
    if (weights.size() != 2) continue;
    std::sort(weights.begin(), weights.end());
    seen[v.point].emplace(v.sphere, weights[0].second, weights[1].second);
  }
  CHECK(seen.size() > 10);
  for (const auto& [p, versions] : seen) CHECK(versions.size() == 1);
}

TEST_CASE("a crossing that rounding put on the wrong side moves along its border; too far, and the cut is refused") {
  // Four triangles around a crossing on the plane x = y, between two vertices on it.
  const std::int32_t m = 1 << 23;
  const std::vector<GridPoint> given{{m, m, -2}, {m, m, 2}, {m + 50, m - 50, 0}, {m - 50, m + 50, 0}};
  const std::vector<Triangle> pieces{{2, 0, 4}, {1, 2, 4}, {3, 1, 4}, {0, 3, 4}};
  const auto positive = [&](const GridPoint& crossing) {
    const auto at = [&](Index i) { return i == 4 ? crossing : given[i]; };
    return std::all_of(pieces.begin(), pieces.end(),
                       [&](const Triangle& t) { return sphere::orientation(at(t[0]), at(t[1]), at(t[2])) == 1; });
  };
  REQUIRE(positive({m, m, 0}));
  for (const std::int32_t off : {2, 3, 4, -3}) {
    CAPTURE(off);
    std::vector<AddedPoint> added{{{m, m, off}, 0, 2}};
    CHECK_FALSE(positive(added[0].sphere));
    unfold(pieces, given, added);
    CHECK(positive(added[0].sphere));
    CHECK(added[0].sphere[0] == added[0].sphere[1]);
  }
  std::vector<AddedPoint> lost{{{m, m, 40}, 0, 2}};
  CHECK_THROWS_AS(unfold(pieces, given, lost), Error);
  std::vector<AddedPoint> corner{{{m, m, 3}, 0, 0}}; // a corner of the cube stays where it is
  CHECK_THROWS_AS(unfold(pieces, given, corner), Error);
}
