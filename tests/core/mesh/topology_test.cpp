#include <doctest/doctest.h>

#include <algorithm>

#include "core/mesh/topology.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::TriangleMesh;

namespace {

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<mesh::Index>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const mesh::Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

} // namespace

TEST_CASE("closed surfaces without handles are spheres") {
  for (const TriangleMesh& m :
       {shapes::tetrahedron(), shapes::sphere(3), shapes::bipyramid(1000), shapes::tube(40, 5, 100)}) {
    const mesh::Topology t = mesh::classify(m);
    CHECK(t.is_sphere());
    CHECK(t.refusal().empty());
    CHECK(t.euler_characteristic == 2);
    CHECK(t.genus == 0);
    CHECK(t.signed_volume > 0);
    CHECK(t.vertices == m.positions.size());
    CHECK(2 * t.edges == 3 * t.triangles);
  }
}

TEST_CASE("a torus has genus 1, and the refusal says so") {
  const mesh::Topology t = mesh::classify(shapes::torus(12, 8));
  CHECK_FALSE(t.is_sphere());
  CHECK(t.genus == 1);
  CHECK(t.refusal().find("genus 1") != std::string::npos);
}

TEST_CASE("a missing triangle is one boundary loop of three edges") {
  TriangleMesh m = shapes::sphere(2);
  m.triangles.pop_back();
  const mesh::Topology t = mesh::classify(m);
  CHECK(t.boundary_loops == 1);
  CHECK(t.boundary_edges == 3);
  CHECK(t.refusal().find("1 boundary loop (3 open edges)") != std::string::npos);
  REQUIRE_FALSE(t.where.empty());
  CHECK(t.where[0].find("boundary loop of 3 edges at (") == 0);
}

TEST_CASE("two spheres are two components") {
  const mesh::Topology t = mesh::classify(joined(shapes::sphere(1), shapes::tetrahedron()));
  CHECK(t.components == 2);
  CHECK(t.refusal().find("2 components") != std::string::npos);
}

TEST_CASE("two spheres that share one vertex have one non-manifold vertex") {
  TriangleMesh m = joined(shapes::tetrahedron(), shapes::tetrahedron());
  for (mesh::Triangle& t : m.triangles) std::ranges::replace(t, 4U, 0U);
  const mesh::Topology t = mesh::classify(m);
  CHECK(t.components == 1);
  CHECK(t.nonmanifold_vertices == 1);
  CHECK(t.nonmanifold_edges == 0);
  CHECK_FALSE(t.is_sphere());
}

TEST_CASE("a doubled triangle makes three non-manifold edges") {
  TriangleMesh m = shapes::sphere(1);
  m.triangles.push_back(m.triangles.front());
  const mesh::Topology t = mesh::classify(m);
  CHECK(t.nonmanifold_edges == 3);
  CHECK(t.duplicate_triangles == 1);
}

TEST_CASE("two triangles back to back are no sphere") {
  const TriangleMesh m{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  CHECK_FALSE(mesh::classify(m).is_sphere());
  CHECK_FALSE(mesh::classify(m).refusal().empty());
}

TEST_CASE("a surface with one side is told from one with mixed windings") {
  // A Moebius strip of five triangles.
  const TriangleMesh strip{{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 1}, {0, 1, 1}},
                           {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}}};
  CHECK_FALSE(mesh::classify(strip).orientable);
  TriangleMesh mixed = shapes::sphere(2);
  std::swap(mixed.triangles[7][0], mixed.triangles[7][1]);
  CHECK(mesh::classify(mixed).orientable);
  CHECK_FALSE(mesh::classify(mixed).consistently_oriented);
  CHECK(mesh::classify(mixed).is_sphere());
}

TEST_CASE("mixed windings are turned outward, whichever triangles were turned") {
  for (const std::size_t step : {2U, 3U, 7U}) {
    const TriangleMesh good = shapes::bumpy_sphere(3);
    TriangleMesh m = good;
    std::vector<std::uint32_t> expected;
    for (std::size_t t = 0; t < m.triangles.size(); t += step) {
      std::swap(m.triangles[t][1], m.triangles[t][2]);
      expected.push_back(static_cast<std::uint32_t>(t));
    }
    CHECK(mesh::orient_consistently(m) == expected);
    CHECK(m.triangles == good.triangles);
  }
}

TEST_CASE("a surface that is inside out but consistent is left alone") {
  TriangleMesh m = shapes::sphere(2);
  for (mesh::Triangle& t : m.triangles) std::swap(t[1], t[2]);
  const auto before = m.triangles;
  CHECK(mesh::classify(m).signed_volume < 0);
  CHECK(mesh::orient_consistently(m).empty());
  CHECK(m.triangles == before);
}

TEST_CASE("unused vertices do not count") {
  TriangleMesh m = shapes::tetrahedron();
  m.positions.push_back({9, 9, 9});
  CHECK(mesh::classify(m).vertices == 4);
  CHECK(mesh::classify(m).components == 1);
}
