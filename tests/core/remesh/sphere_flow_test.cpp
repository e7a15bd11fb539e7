#include "core/remesh/sphere_flow.h"

#include <doctest/doctest.h>

#include "core/remesh/polyhedron.h"

using namespace orbis;

TEST_CASE("a flow takes landmarks to their ends, leaves nothing folded, and is the same on any number of threads") {
  const auto mesh = remesh::subdivided(RemeshTarget::Base::icosahedral, 5);
  const std::vector<Vec3d> from{{1, 0, 0}, {0, 1, 0}, normalized(Vec3d{1, 1, 1}), {0, 0, -1}};
  const std::vector<Vec3d> to{
      normalized(Vec3d{1, 0.4, 0}), normalized(Vec3d{-0.3, 1, 0.2}), normalized(Vec3d{1, 0.6, 1.3}), {0, 0, -1}};
  mesh::ThreadPool one(1), three(3);
  const std::vector<Vec3d> ends = remesh::carried(from, from, to, one);
  for (std::size_t i = 0; i < to.size(); ++i) CHECK(norm(ends[i] - to[i]) < 1e-3);
  const std::vector<Vec3d> moved = remesh::carried(mesh.points, from, to, one);
  for (const Vec3d& p : moved) CHECK(norm(p) == doctest::Approx(1).epsilon(1e-12));
  for (const auto& [a, b, c] : mesh.triangles)
    CHECK(dot(moved[a], cross(moved[b] - moved[a], moved[c] - moved[a])) > 0);
  CHECK(remesh::carried(mesh.points, from, to, three) == moved);
}

TEST_CASE("without landmarks, and with landmarks that stay, nothing moves") {
  const auto mesh = remesh::subdivided(RemeshTarget::Base::octahedral, 2);
  mesh::ThreadPool pool(1);
  CHECK(remesh::carried(mesh.points, {}, {}, pool) == mesh.points);
  const std::vector<Vec3d> fixed{{1, 0, 0}, {0, 0, 1}};
  const std::vector<Vec3d> after = remesh::carried(mesh.points, fixed, fixed, pool);
  for (std::size_t v = 0; v < after.size(); ++v) CHECK(norm(after[v] - mesh.points[v]) < 1e-12);
}
