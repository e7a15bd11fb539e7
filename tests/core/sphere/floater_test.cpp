#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/sphere/floater_weights.h"

namespace {

using orbis::Vec3d;
using orbis::sphere::floater_weights;

std::vector<Vec3d> planar_ring(const std::vector<std::array<double, 2>>& polar) {
  std::vector<Vec3d> ring;
  for (const auto& [radius, angle] : polar) ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  return ring;
}

void check_positive_of_sum_one(const std::vector<double>& weights) {
  for (const double w : weights) {
    CHECK(w > 0);
    CHECK(std::isfinite(w));
  }
  CHECK(std::accumulate(weights.begin(), weights.end(), 0.0) == doctest::Approx(1).epsilon(1e-12));
}

Vec3d weighted_mean(const std::vector<Vec3d>& ring, const std::vector<double>& weights) {
  Vec3d mean;
  for (std::size_t k = 0; k < ring.size(); ++k) mean += ring[k] * weights[k];
  return mean;
}

} // namespace

TEST_CASE("a regular planar star has equal weights") {
  for (const int d : {3, 4, 5, 6, 7, 100}) {
    std::vector<std::array<double, 2>> polar;
    for (int k = 0; k < d; ++k) polar.push_back({2.5, 2 * std::numbers::pi * k / d});
    const auto weights = floater_weights({}, planar_ring(polar));
    for (const double w : weights) CHECK(w == doctest::Approx(1.0 / d).epsilon(1e-9));
  }
}

TEST_CASE("the weights of a planar star reproduce its centre") {
  // Uneven edges and angles, none of more than pi; the second star is not convex.
  const std::vector<std::vector<std::array<double, 2>>> stars{
      {{1, 0}, {0.2, 1.1}, {3, 2.5}, {1, 4}, {0.7, 4.2}},
      {{1, 0}, {0.1, 0.8}, {2, 1.5}, {0.15, 3}, {1, 4.5}, {5, 5.5}},
      {{1, 0}, {1, 2}, {1, 4}},
      {{1e-3, 0.1}, {1e2, 1.5}, {1, 3.1}, {7, 5.1}},
  };
  for (const auto& polar : stars) {
    const std::vector<Vec3d> ring = planar_ring(polar);
    const auto weights = floater_weights({}, ring);
    check_positive_of_sum_one(weights);
    CHECK(norm(weighted_mean(ring, weights)) < 1e-9);
  }
}

TEST_CASE("the weights do not depend on where the star lies, how large it is, or how it is turned in space") {
  const std::vector<Vec3d> ring{{1, 0, 0.3}, {0.4, 1, -0.2}, {-1, 0.5, 0.1}, {-0.3, -0.8, 0.6}};
  const auto weights = floater_weights({}, ring);
  std::vector<Vec3d> moved;
  const Vec3d shift(3, -2, 7);
  for (const Vec3d& q : ring) moved.push_back(Vec3d(q.z, q.x, q.y) * 1e-20 + shift * 0.0);
  const auto small = floater_weights({}, moved);
  for (Vec3d& q : moved) q = q * 1e20 + shift;
  const auto shifted = floater_weights(shift, moved);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    CHECK(small[k] == doctest::Approx(weights[k]).epsilon(1e-9));
    CHECK(shifted[k] == doctest::Approx(weights[k]).epsilon(1e-9));
  }
}

TEST_CASE("a pyramid's apex is flattened: equal sides give equal weights whatever the height") {
  for (const double height : {0.0, 1.0, 100.0}) {
    const std::vector<Vec3d> base{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    for (const double w : floater_weights({0, 0, height}, base)) CHECK(w == doctest::Approx(0.25).epsilon(1e-6));
  }
}

TEST_CASE("degenerate stars have positive, finite weights of sum 1") {
  const Vec3d a(1, 0, 0), b(0, 1, 0), c(-1, 0, 0), o(0, 0, 0);
  const std::vector<std::vector<Vec3d>> stars{
      {o, o, o},                // all edges have length zero
      {o, a, b, c},             // one has
      {a, a, a},                // all angles are zero
      {a, a, c, c},             // two are
      {a, c, a},                // folded onto a line
      {a, b, a},                // folded onto itself
      {a, b, c},                // one angle is exactly pi
      {a * 1e-30, b, c * 1e30}, // hopeless ratios
  };
  for (const auto& ring : stars) check_positive_of_sum_one(floater_weights(o, ring));
}

TEST_CASE("a star of valence 1000 is flattened in one go") {
  std::vector<Vec3d> ring;
  for (int k = 0; k < 1000; ++k) {
    const double angle = 2 * std::numbers::pi * k / 1000;
    ring.emplace_back((2 + std::cos(3 * angle)) * std::cos(angle), (2 + std::cos(3 * angle)) * std::sin(angle), 0.0);
  }
  const auto weights = floater_weights({}, ring);
  check_positive_of_sum_one(weights);
  CHECK(norm(weighted_mean(ring, weights)) < 1e-9);
}
