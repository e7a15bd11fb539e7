#include "core/remesh/sphere_tree.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/remesh/polyhedron.h"

using namespace orbis;

namespace {

Vec3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalized(Vec3d{normal(random), normal(random), normal(random)});
}

Vec3d direction_of(const remesh::SphereMesh& mesh, const remesh::Place& place) {
  Vec3d sum;
  for (std::size_t k = 0; k < 3; ++k) sum += mesh.points[mesh.triangles[place.triangle][k]] * place.weights[k];
  return normalized(sum);
}

// Pulled towards a pole until most triangles are needles.
remesh::SphereMesh needles() {
  remesh::SphereMesh mesh = remesh::subdivided(RemeshTarget::Base::octahedral, 4);
  for (Vec3d& p : mesh.points) p = normalized(Vec3d{p.x * 1e-4, p.y, p.z});
  return mesh;
}

} // namespace

TEST_CASE("every direction has a place, and the place is in that direction") {
  std::mt19937 random(7);
  for (const remesh::SphereMesh& mesh : {remesh::subdivided(RemeshTarget::Base::icosahedral, 0),
                                         remesh::subdivided(RemeshTarget::Base::octahedral, 5), needles()}) {
    const remesh::SphereTree tree(mesh.points, mesh.triangles);
    for (int i = 0; i < 2000; ++i) {
      const Vec3d d = random_direction(random);
      const remesh::Place place = tree.locate(d);
      double sum = 0;
      for (const double w : place.weights) {
        CHECK(w >= 0);
        sum += w;
      }
      CHECK(sum == doctest::Approx(1).epsilon(1e-14));
      CHECK(norm(direction_of(mesh, place) - d) < 1e-12);
    }
  }
}

TEST_CASE("a vertex' direction is at that vertex, and an edge's middle is on that edge") {
  const auto mesh = remesh::subdivided(RemeshTarget::Base::icosahedral, 3);
  const remesh::SphereTree tree(mesh.points, mesh.triangles);
  for (const Vec3d& p : mesh.points) {
    const remesh::Place place = tree.locate(p);
    CHECK(norm(direction_of(mesh, place) - p) < 1e-15);
    CHECK(std::max({place.weights[0], place.weights[1], place.weights[2]}) > 1 - 1e-12);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const remesh::Place place = tree.locate(normalized(mesh.points[a] + mesh.points[b]));
    CHECK(std::min({place.weights[0], place.weights[1], place.weights[2]}) < 1e-12);
  }
}

TEST_CASE("what is near a triangle includes every triangle that shares a point with it") {
  const auto mesh = remesh::subdivided(RemeshTarget::Base::octahedral, 3);
  const remesh::SphereTree tree(mesh.points, mesh.triangles);
  for (const mesh::Triangle& t : mesh.triangles) {
    std::vector<bool> found(mesh.triangles.size());
    tree.near({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, [&](std::uint32_t s) { found[s] = true; });
    for (std::size_t s = 0; s < mesh.triangles.size(); ++s) {
      for (const mesh::Index v : mesh.triangles[s])
        if (v == t[0] || v == t[1] || v == t[2]) CHECK(found[s]);
    }
  }
}
