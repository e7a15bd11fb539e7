#include "core/lod/deviation_quadric.h"

#include <doctest/doctest.h>

#include <random>

#include "core/lod/uv_orientation.h"

using namespace orbis;

namespace {

struct Map {
  std::array<Vec3d, 2> a;
  Vec3d b;
  [[nodiscard]] Vec3d at(const lod::Uv& u) const { return a[0] * u[0] + a[1] * u[1] + b; }
  [[nodiscard]] Vec3d normal() const { return normalized(cross(a[0], a[1])); }
};

Map random_map(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&] { return Vec3d{any(random), any(random), any(random)}; };
  return {{vector(), vector()}, vector()};
}

lod::DeviationQuadric quadric(const Map& m, double w, double slip) {
  return lod::DeviationQuadric::of_map(m.a, m.b, m.normal(), w, slip);
}

} // namespace

TEST_CASE("the quadric is the weighted square of the distance and of the slip") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Map map = random_map(random);
    const lod::DeviationQuadric q = quadric(map, 3, 0.25);
    const lod::Uv u{any(random), any(random)};
    const Vec3d n = map.normal(), along = normalized(map.a[0]);
    CHECK(q.at(u).value(map.at(u)) == doctest::Approx(0).epsilon(1e-9));
    CHECK(q.at(u).value(map.at(u) + n * 0.5) == doctest::Approx(3 * 0.25));
    CHECK(q.at(u).value(map.at(u) + along * 0.5) == doctest::Approx(3 * 0.25 * 0.25));
  }
}

TEST_CASE("no position and no place is better than the best ones") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 100; ++i) {
    lod::DeviationQuadric q;
    for (int k = 0; k < 4; ++k) q += quadric(random_map(random), 0.5 + k, 0.2);
    const lod::Uv from{any(random), any(random)};
    const auto u = q.best_place(from);
    REQUIRE(u);
    const auto best = q.at(*u).minimiser();
    REQUIRE(best);
    const double least = q.at(*u).value(*best);
    const auto at_from = q.at(from).minimiser();
    REQUIRE(at_from);
    CHECK(least <= q.at(from).value(*at_from) + 1e-12);
    for (int k = 0; k < 10; ++k) {
      const Vec3d off = Vec3d{any(random), any(random), any(random)} * 0.1;
      CHECK(q.at(*u).value(*best + off) >= least - 1e-12);
    }
  }
}

TEST_CASE("on a flat surface that is mapped evenly a vertex keeps the place that it was asked for") {
  const Map map{{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}, {0, 0, 2}};
  lod::DeviationQuadric q = quadric(map, 1, 0.2);
  q += quadric(map, 2, 0.2);
  const auto u = q.best_place({0.3, 0.7});
  REQUIRE(u);
  CHECK((*u)[0] == doctest::Approx(0.3));
  CHECK((*u)[1] == doctest::Approx(0.7));
}

TEST_CASE("orientation in the atlas is exact where doubles would round") {
  // Three points of one line whose products round, and their neighbours by one float.
  const Vec2f a{0.1F, 0.1F}, b{0.3F, 0.3F}, c{0.7F, 0.7F};
  CHECK(lod::uv_orientation(a, b, c) == 0);
  CHECK(lod::uv_orientation(a, b, {0.7F, std::nextafter(0.7F, 1.0F)}) == 1);
  CHECK(lod::uv_orientation(a, b, {0.7F, std::nextafter(0.7F, 0.0F)}) == -1);
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int64_t> any(0, 1 << 23);
  for (int i = 0; i < 10'000; ++i) {
    // Multiples of 2^-23, nearly on a line; the sign on integers is exact.
    std::array<std::int64_t, 6> n{};
    for (auto& x : n) x = any(random);
    n[4] = n[0] + (n[2] - n[0]) / 3 + static_cast<std::int64_t>(i % 3) - 1;
    n[5] = n[1] + (n[3] - n[1]) / 3;
    const auto f = [&](std::size_t k) { return static_cast<float>(n[k]) / (1 << 23); };
    const std::int64_t area = (n[2] - n[0]) * (n[5] - n[1]) - (n[3] - n[1]) * (n[4] - n[0]);
    CHECK(lod::uv_orientation({f(0), f(1)}, {f(2), f(3)}, {f(4), f(5)}) == (area > 0) - (area < 0));
  }
}
