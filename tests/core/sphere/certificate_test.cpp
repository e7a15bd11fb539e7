#include <doctest/doctest.h>

#include <random>

#include "core/sphere/certificate.h"
#include "core/sphere/orientation.h"
#include "support/shapes.h"

using namespace orbis;
using sphere::GridPoint;

namespace {

std::vector<Vec3f> on_grid(const mesh::TriangleMesh& m) {
  std::vector<Vec3f> out;
  for (const Vec3f& p : m.positions) out.push_back(sphere::from_grid(sphere::to_grid(normalized(Vec3d(p)))));
  return out;
}

} // namespace

TEST_CASE("a convex mesh projected from its centre is certified") {
  for (const auto& m : {shapes::tetrahedron(), shapes::sphere(4), shapes::bipyramid(100)}) {
    const sphere::Certificate c = sphere::certify(on_grid(m), m.triangles);
    CHECK(c.valid);
    CHECK(c.failure().empty());
    CHECK(c.degree == doctest::Approx(1));
    CHECK(c.max_radius_error < 1e-7);
  }
}

TEST_CASE("one folded triangle is found") {
  const auto m = shapes::sphere(4);
  std::vector<Vec3f> points = on_grid(m);
  points[m.triangles[100][0]] = points[m.triangles[900][0]];
  const sphere::Certificate c = sphere::certify(points, m.triangles);
  CHECK_FALSE(c.valid);
  CHECK(c.folded > 0);
  CHECK(c.failure().find("folded") != std::string::npos);
}

TEST_CASE("a mirrored sphere has degree -1 and folds everywhere") {
  const auto m = shapes::sphere(3);
  std::vector<Vec3f> points = on_grid(m);
  for (Vec3f& p : points) p.z = -p.z;
  const sphere::Certificate c = sphere::certify(points, m.triangles);
  CHECK(c.folded == m.triangles.size());
  CHECK(c.degree == doctest::Approx(-1));
}

TEST_CASE("a double covering is refused though every triangle is positive") {
  // A bipyramid whose ring goes around the axis twice: positive everywhere but at the branch points, the poles.
  constexpr mesh::Index n = 12;
  const auto m = shapes::bipyramid(n);
  std::vector<Vec3f> points = on_grid(m);
  for (mesh::Index i = 0; i < n; ++i) {
    const double a = 4 * std::numbers::pi * i / n;
    points[i] = sphere::from_grid(sphere::to_grid({std::cos(a), std::sin(a), 0}));
  }
  const sphere::Certificate c = sphere::certify(points, m.triangles);
  CHECK(c.folded == 0);
  CHECK(c.degree == doctest::Approx(2));
  CHECK_FALSE(c.valid);
}

TEST_CASE("open, non-manifold and handled surfaces are refused") {
  auto m = shapes::sphere(3);
  const std::vector<Vec3f> points = on_grid(m);
  m.triangles.pop_back();
  CHECK_FALSE(sphere::certify(points, m.triangles).closed);
  const auto torus = shapes::torus(8, 8);
  CHECK(sphere::certify(on_grid(torus), torus.triangles).euler_characteristic == 0);
  CHECK_FALSE(sphere::certify(on_grid(torus), torus.triangles).valid);
}

TEST_CASE("coordinates off the grid are refused, NaN too") {
  const auto m = shapes::sphere(2);
  std::vector<Vec3f> points = on_grid(m);
  points[3].x = std::nextafter(0.1F, 1.0F);
  CHECK(sphere::certify(points, m.triangles).off_grid == 1);
  points[3].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(sphere::certify(points, m.triangles).off_grid == 1);
  CHECK_FALSE(sphere::certify(points, m.triangles).valid);
}

TEST_CASE("indices out of range are refused, not followed") {
  const auto m = shapes::tetrahedron();
  auto triangles = m.triangles;
  triangles[0][0] = 77;
  CHECK_FALSE(sphere::certify(on_grid(m), triangles).valid);
}

TEST_CASE("orientation is exact where doubles are not") {
  constexpr std::int32_t one = 1 << sphere::grid_bits;
  // Almost one point, one unit apart, near the corner of the grid.
  const GridPoint a{one, one, one}, b{one - 1, one, one}, c{one, one - 1, one};
  CHECK(sphere::orientation(a, b, c) == -sphere::orientation(a, c, b));
  CHECK(sphere::orientation(a, b, c) != 0);
  CHECK(sphere::orientation(a, b, b) == 0);
  // Three points in a plane with the centre.
  CHECK(sphere::orientation({one, 0, 0}, {one - 5, 7, 0}, {-3, one, 0}) == 0);
}

TEST_CASE("orientation is antisymmetric and invariant under rotation of its arguments") {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> coordinate(-(1 << 24), 1 << 24);
  std::uniform_int_distribution<std::int32_t> small(-2, 2);
  for (int i = 0; i < 20'000; ++i) {
    const GridPoint a{coordinate(random), coordinate(random), coordinate(random)};
    GridPoint b = a, c = a;
    for (std::size_t k = 0; k < 3; ++k) {
      b[k] = std::clamp(a[k] + small(random), -(1 << 24), 1 << 24);
      c[k] = i % 2 == 0 ? coordinate(random) : std::clamp(a[k] + small(random), -(1 << 24), 1 << 24);
    }
    const int sign = sphere::orientation(a, b, c);
    CHECK(sphere::orientation(b, c, a) == sign);
    CHECK(sphere::orientation(c, a, b) == sign);
    CHECK(sphere::orientation(b, a, c) == -sign);
  }
}

TEST_CASE("grid points survive the way through float") {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::int32_t> coordinate(-(1 << 24), 1 << 24);
  for (int i = 0; i < 20'000; ++i) {
    const GridPoint p{coordinate(random), coordinate(random), coordinate(random)};
    GridPoint q{};
    REQUIRE(sphere::grid_point_of(sphere::from_grid(p), q));
    CHECK(p == q);
  }
}

TEST_CASE("pieces without their cap are certified together with the cap's solid angle, and not without") {
  const auto m = shapes::sphere(3);
  const std::vector<Vec3f> points = on_grid(m);
  const auto pieces = std::span(m.triangles).subspan(5), cap = std::span(m.triangles).first(5);
  const double missing = sphere::solid_angle_of(points, cap);
  CHECK(missing > 0);
  CHECK(sphere::certify_pieces(points, pieces, missing).valid);
  CHECK_FALSE(sphere::certify_pieces(points, pieces, 4 * std::numbers::pi).valid);
  std::vector<mesh::Triangle> twice(pieces.begin(), pieces.end());
  twice.push_back(twice.front());
  CHECK_FALSE(sphere::certify_pieces(points, twice, missing).valid);
}
