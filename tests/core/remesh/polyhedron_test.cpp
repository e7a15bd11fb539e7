#include "core/remesh/polyhedron.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/mesh/topology.h"

using namespace orbis;

namespace {

std::vector<int> valences(const remesh::SphereMesh& mesh) {
  std::vector<int> out(mesh.points.size());
  for (const mesh::Triangle& t : mesh.triangles)
    for (const mesh::Index v : t) ++out[v];
  return out;
}

} // namespace

TEST_CASE(
    "a divided polyhedron is a sphere whose triangles run counter-clockwise, and regular but for its own corners") {
  for (const auto base : {RemeshTarget::Base::octahedral, RemeshTarget::Base::icosahedral}) {
    const bool octahedral = base == RemeshTarget::Base::octahedral;
    for (std::uint32_t times = 0; times <= 4; ++times) {
      const remesh::SphereMesh mesh = remesh::subdivided(base, times);
      CHECK(mesh.triangles.size() == remesh::triangles_of(base, times));
      mesh::TriangleMesh flat;
      for (const Vec3d& p : mesh.points) {
        CHECK(norm(p) == doctest::Approx(1).epsilon(1e-14));
        flat.positions.emplace_back(p);
      }
      flat.triangles = mesh.triangles;
      CHECK(mesh::classify(flat).is_sphere());
      for (const auto& [a, b, c] : mesh.triangles)
        CHECK(dot(mesh.points[a], cross(mesh.points[b], mesh.points[c])) > 0);
      std::vector<int> found = valences(mesh);
      const std::ptrdiff_t corners = octahedral ? 6 : 12;
      CHECK(std::all_of(found.begin(), found.begin() + corners, [&](int n) { return n == (octahedral ? 4 : 5); }));
      CHECK(std::all_of(found.begin() + corners, found.end(), [](int n) { return n == 6; }));
    }
  }
}

TEST_CASE("a subdivision keeps the vertices of the one before, and a triangle's four parts are together") {
  const auto coarse = remesh::subdivided(RemeshTarget::Base::icosahedral, 2);
  const auto fine = remesh::subdivided(RemeshTarget::Base::icosahedral, 3);
  for (std::size_t v = 0; v < coarse.points.size(); ++v) CHECK(fine.points[v] == coarse.points[v]);
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) CHECK(fine.triangles[4 * t + k][0] == coarse.triangles[t][k]);
}
