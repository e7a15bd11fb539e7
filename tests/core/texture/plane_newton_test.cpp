// Newton's method on a flat map: it ends in a minimum that sweeps over single points do not come to.
#include "core/texture/plane_newton.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace orbis;
using namespace orbis::texture;

namespace {

constexpr std::uint32_t rings = 24, around = 12;

// A tube with a lid, a glove's finger, standing on a square sheet: concentric rings about the middle of the square,
// most of them on the tube.
PlaneMesh finger(double depth) {
  PlaneMesh mesh;
  std::vector<Vec3d> positions;
  mesh.points.push_back({0.5, 0.5});
  positions.push_back({0, 0, depth});
  for (std::uint32_t r = 1; r <= rings; ++r)
    for (std::uint32_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / around, part = static_cast<double>(r) / rings;
      const double c = std::cos(angle), s = std::sin(angle);
      // The outermost ring lies on the square's sides.
      const double out = 0.5 * part * (1 + (part > 0.99 ? 1 / std::max(std::abs(c), std::abs(s)) - 1 : 0));
      mesh.points.push_back({0.5 + out * c, 0.5 + out * s});
      positions.push_back({c * (r < rings ? 1 : 2), -s * (r < rings ? 1 : 2), depth * (rings - r) / (rings - 1.0)});
    }
  const auto at = [](std::uint32_t r, std::uint32_t k) { return 1 + (r - 1) * around + k % around; };
  for (std::uint32_t k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, at(1, k + 1), at(1, k)});
    for (std::uint32_t r = 1; r < rings; ++r) {
      mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k)});
      mesh.triangles.push_back({at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)});
    }
  }
  for (FlatPoint& p : mesh.points) {
    for (double* const x : {&p.x, &p.y})
      if (std::abs(*x - std::round(*x)) < 1e-9) *x = std::round(*x);
    mesh.fixed_x.push_back(p.x == 0 || p.x == 1);
    mesh.fixed_y.push_back(p.y == 0 || p.y == 1);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    mesh.references.push_back(plane_reference(positions[a], positions[b], positions[c]));
  return mesh;
}

double least_doubled_area(const PlaneMesh& mesh) {
  double least = 1e300;
  for (const auto& [a, b, c] : mesh.triangles)
    least = std::min(least, doubled_area(mesh.points[a], mesh.points[b], mesh.points[c]));
  return least;
}

} // namespace

TEST_CASE("what sweeps leave of the energy of a deep cup, Newton's method takes away, without a fold") {
  for (const int exponent : {4, 8}) {
    PlaneMesh swept = finger(20);
    REQUIRE(least_doubled_area(swept) > 0);
    swept.exponent = exponent;
    stretch_to_best(swept);
    PlaneMesh lowered = swept;
    for (int i = 0; i < 10; ++i) {
      relax(swept, 12);
      stretch_to_best(swept);
    }
    lower_by_newton(lowered);
    CHECK(least_doubled_area(lowered) > 0);
    CHECK(energy_of(lowered) < energy_of(swept));
  }
}

TEST_CASE("where Newton's method ends, no way leads down") {
  PlaneMesh mesh = finger(20);
  stretch_to_best(mesh);
  lower_by_newton(mesh);
  lower_by_newton(mesh);
  const double least = energy_of(mesh);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(-1e-3, 1e-3);
  for (int trial = 0; trial < 100; ++trial) {
    PlaneMesh other = mesh;
    for (std::size_t v = 0; v < other.points.size(); ++v) {
      const double dx = part(random), dy = part(random);
      if (!other.fixed_x[v]) other.points[v].x += dx;
      if (!other.fixed_y[v]) other.points[v].y += dy;
    }
    CHECK(energy_of(other) > least * (1 - 1e-4));
  }
}

TEST_CASE("points on a side stay on it, and sides stay straight") {
  PlaneMesh mesh = finger(5);
  const PlaneMesh before = mesh;
  lower_by_newton(mesh);
  double width = 0, height = 0;
  for (const FlatPoint& p : mesh.points) {
    width = std::max(width, p.x);
    height = std::max(height, p.y);
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (mesh.fixed_x[v]) CHECK(mesh.points[v].x == (before.points[v].x > 0.5 ? width : before.points[v].x));
    if (mesh.fixed_y[v]) CHECK(mesh.points[v].y == (before.points[v].y > 0.5 ? height : before.points[v].y));
  }
}
