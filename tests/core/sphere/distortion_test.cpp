#include <doctest/doctest.h>

#include <cmath>

#include "core/sphere/distortion.h"
#include "support/shapes.h"

using namespace orbis;

TEST_CASE("a mesh whose map is itself has no distortion, at any size") {
  mesh::TriangleMesh m = shapes::sphere(4);
  const std::vector<Vec3f> points = m.positions;
  for (const float size : {1.0F, 1e-30F, 1e30F}) {
    for (std::size_t v = 0; v < points.size(); ++v) m.positions[v] = points[v] * size;
    const sphere::Distortion d = sphere::measure_distortion(m, points);
    CHECK(d.symmetric_dirichlet == doctest::Approx(1));
    CHECK(d.l2_stretch == doctest::Approx(1));
    CHECK(d.quasi_conformal_mean == doctest::Approx(1).epsilon(1e-3));
    CHECK(d.log_area_deviation == doctest::Approx(0).epsilon(1e-5));
    CHECK(d.needles == 0);
  }
}

TEST_CASE("a known stretch is measured") {
  // Twice as long in x as the map: s1 = sqrt 2, s2 = 1 / sqrt 2..
  mesh::TriangleMesh m{{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const std::vector<Vec3f> points{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const sphere::Distortion d = sphere::measure_distortion(m, points);
  CHECK(d.quasi_conformal_mean == doctest::Approx(2));
  CHECK(d.symmetric_dirichlet == doctest::Approx((2 + 0.5 + 0.5 + 2) / 4));
  CHECK(d.l2_stretch == doctest::Approx(std::sqrt((0.5 + 2) / 2)));
}

TEST_CASE("needles neither count nor set the scale") {
  mesh::TriangleMesh m = shapes::sphere(4);
  const std::vector<Vec3f> points = m.positions;
  m.positions[17].x = 3e38F;
  const sphere::Distortion d = sphere::measure_distortion(m, points);
  CHECK(d.needles >= 4);
  CHECK(d.symmetric_dirichlet == doctest::Approx(1).epsilon(0.01));
}
