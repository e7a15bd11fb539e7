#include <doctest/doctest.h>

#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::Triangle;

namespace {

// Every triangle with three vertices of its own.
mesh::TriangleMesh soup_of(const mesh::TriangleMesh& m) {
  mesh::TriangleMesh out;
  for (const Triangle& t : m.triangles) {
    const auto first = static_cast<mesh::Index>(out.positions.size());
    for (const mesh::Index v : t) out.positions.push_back(m.positions[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

} // namespace

TEST_CASE("welding a triangle soup restores the mesh it came from") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(4);
  const mesh::TriangleMesh soup = soup_of(m);
  const mesh::Welded w = mesh::weld(soup.positions, soup.triangles);
  CHECK(w.mesh.positions.size() == m.positions.size());
  CHECK(w.degenerate.empty());
  CHECK(mesh::classify(w.mesh).is_sphere());
  for (std::size_t v = 0; v < soup.positions.size(); ++v) CHECK(w.mesh.positions[w.vertex_of[v]] == soup.positions[v]);
}

TEST_CASE("minus zero equals zero") {
  const std::vector<Vec3f> positions{{0.0F, 1, 2}, {-0.0F, 1, 2}, {1, 0, 0}, {0, 0, 1}};
  const std::vector<Triangle> triangles{{0, 2, 3}, {1, 3, 2}};
  CHECK(mesh::weld(positions, triangles).mesh.positions.size() == 3);
}

TEST_CASE("a triangle whose corners become one vertex is left out and named") {
  const std::vector<Vec3f> positions{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 2, 3}, {0, 1, 2}};
  const mesh::Welded w = mesh::weld(positions, triangles);
  CHECK(w.degenerate == std::vector<std::uint32_t>{1});
  CHECK(w.triangle_of == std::vector<std::uint32_t>{0});
}

TEST_CASE("vertices that no triangle uses are not part of the surface") {
  const std::vector<Vec3f> positions{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{1, 2, 3}};
  for (const mesh::Welded& w : {mesh::weld(positions, triangles), mesh::keep_indices(positions, triangles)}) {
    CHECK(w.mesh.positions.size() == 3);
    CHECK(w.vertex_of[0] == mesh::unreferenced);
  }
}

TEST_CASE("kept indices leave coincident vertices apart") {
  mesh::TriangleMesh m = shapes::sphere(2);
  m.positions[5] = m.positions[m.triangles[0][0] == 5 ? m.triangles[0][1] : m.triangles[0][0]];
  CHECK(mesh::keep_indices(m.positions, m.triangles).mesh.positions.size() == m.positions.size());
  CHECK(mesh::weld(m.positions, m.triangles).mesh.positions.size() == m.positions.size() - 1);
}

TEST_CASE("within a tolerance vertices go to the nearest one before them, and chains do not form") {
  const std::vector<Vec3f> positions{{0, 0, 0}, {0.9F, 0, 0}, {1.8F, 0, 0}, {0, 5, 0}, {0, 0, -0.5F}};
  const std::vector<Triangle> triangles{{0, 2, 3}, {1, 3, 2}, {4, 2, 3}};
  const mesh::Welded w = mesh::weld_within(positions, triangles, 1.0);
  CHECK(w.vertex_of == std::vector<mesh::Index>{0, 0, 1, 2, 0});
  CHECK(w.mesh.positions[0] == positions[0]);
}

TEST_CASE("a jittered soup is restored within a tolerance above the jitter") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(4);
  mesh::TriangleMesh soup = soup_of(m);
  for (std::size_t v = 0; v < soup.positions.size(); ++v) soup.positions[v].y += 1e-5F * static_cast<float>(v % 7);
  CHECK_FALSE(mesh::classify(mesh::weld(soup.positions, soup.triangles).mesh).is_sphere());
  CHECK(mesh::classify(mesh::weld_within(soup.positions, soup.triangles, 1e-3).mesh).is_sphere());
}
