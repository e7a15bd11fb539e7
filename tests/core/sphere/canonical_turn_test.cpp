#include <doctest/doctest.h>

#include <cmath>

#include "core/sphere/canonical_turn.h"
#include "support/shapes.h"

using namespace orbis;

namespace {

Vec3d turned_about_z(const Vec3d& p, double angle) {
  return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
}

} // namespace

TEST_CASE("a sphere's own points, turned any way, come back to where they were") {
  const mesh::TriangleMesh m = shapes::sphere(4);
  for (const double angle : {0.0, 0.3, 2.0, 3.1, -1.0}) {
    std::vector<Vec3d> points;
    for (const Vec3f& p : m.positions) {
      const Vec3d q = turned_about_z(normalized(Vec3d(p)), angle);
      points.push_back(turned_about_z({q.y, q.z, q.x}, angle));
    }
    const std::vector<Vec3d> back = sphere::canonically_turned(m, points);
    for (std::size_t v = 0; v < back.size(); ++v) CHECK(norm(back[v] - normalized(Vec3d(m.positions[v]))) < 1e-6);
  }
}

TEST_CASE("turning keeps distances and orientation") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(3);
  std::vector<Vec3d> points;
  for (const Vec3f& p : m.positions) points.push_back(normalized(Vec3d{p.y, p.z, p.x + 0.1F}));
  const std::vector<Vec3d> turned = sphere::canonically_turned(m, points);
  for (const mesh::Triangle& t : m.triangles) {
    const double before = dot(points[t[0]], cross(points[t[1]], points[t[2]]));
    const double after = dot(turned[t[0]], cross(turned[t[1]], turned[t[2]]));
    CHECK(after == doctest::Approx(before).epsilon(1e-9));
  }
}

TEST_CASE("a surface without area leaves the points alone") {
  mesh::TriangleMesh m = shapes::sphere(2);
  std::vector<Vec3d> points;
  for (const Vec3f& p : m.positions) points.push_back(normalized(Vec3d(p)));
  for (Vec3f& p : m.positions) p.y = p.z = 0;
  CHECK(sphere::canonically_turned(m, points) == points);
}
