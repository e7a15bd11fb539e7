#include "core/remesh/fit.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/shapes.h"

using namespace orbis;

namespace {

// A shape that is seen whole from its centre, so that its own directions are a map to the sphere.
struct Mapped {
  mesh::TriangleMesh mesh;
  std::vector<Vec3d> points;

  explicit Mapped(mesh::TriangleMesh m) : mesh(std::move(m)) {
    for (const Vec3f& p : mesh.positions) points.push_back(normalized(Vec3d(p)));
  }
  [[nodiscard]] remesh::MappedSurface surface() const { return {points, mesh.positions, mesh.triangles}; }
};

// A ball with thorns between the points of any sampling.
mesh::TriangleMesh thorny() {
  mesh::TriangleMesh m = shapes::sphere(4);
  for (std::size_t v = 40; v < m.positions.size(); v += 97) m.positions[v] = m.positions[v] * 1.3F;
  return m;
}

remesh::SphereMesh fitted(const Mapped& shape, std::uint32_t threads) {
  remesh::SphereMesh sampling = remesh::subdivided(RemeshTarget::Base::icosahedral, 3);
  const remesh::SphereTree tree(shape.points, shape.mesh.triangles);
  mesh::ThreadPool pool(threads);
  NoProgress progress;
  remesh::fit_to_surface(sampling, shape.surface(), tree, pool, progress);
  return sampling;
}

std::size_t thorns_hit(const Mapped& shape, const remesh::SphereMesh& sampling) {
  std::size_t hit = 0;
  for (std::size_t v = 40; v < shape.points.size(); v += 97) {
    hit += std::any_of(sampling.points.begin(), sampling.points.end(),
                       [&](const Vec3d& p) { return norm(p - shape.points[v]) < 1e-9; })
               ? 1
               : 0;
  }
  return hit;
}

} // namespace

TEST_CASE("points move to the tips that they would miss, and no triangle folds") {
  const Mapped shape(thorny());
  const remesh::SphereMesh regular = remesh::subdivided(RemeshTarget::Base::icosahedral, 3);
  const remesh::SphereMesh sampling = fitted(shape, 1);
  CHECK(thorns_hit(shape, regular) < 2);
  CHECK(thorns_hit(shape, sampling) >= 9); // of ten or eleven; some share a star
  CHECK(sampling.triangles == regular.triangles);
  for (const auto& [a, b, c] : sampling.triangles) {
    const Vec3d& p = sampling.points[a];
    CHECK(dot(p, cross(sampling.points[b] - p, sampling.points[c] - p)) > 0);
  }
}

TEST_CASE("what is met already stays as it is, and the number of threads changes nothing") {
  const Mapped ball(shapes::sphere(3));
  remesh::SphereMesh same{ball.points, ball.mesh.triangles};
  const remesh::SphereTree tree(ball.points, ball.mesh.triangles);
  mesh::ThreadPool pool(1);
  NoProgress progress;
  remesh::fit_to_surface(same, ball.surface(), tree, pool, progress);
  CHECK(same.points == ball.points);

  const Mapped shape(thorny());
  CHECK(fitted(shape, 1).points == fitted(shape, 3).points);
}
