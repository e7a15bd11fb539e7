// The energy that lays charts flat: what it is, and that a higher exponent evens areas out further.
#include "core/texture/plane_energy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace orbis;
using namespace orbis::texture;

namespace {

constexpr std::uint32_t n = 24;

// A tall bump over a square field, laid out as the field: most of its surface is in a few small triangles.
PlaneMesh bump(double height) {
  PlaneMesh mesh;
  std::vector<Vec3d> positions;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      const double from_centre = std::hypot(x - 0.5, y - 0.5);
      positions.push_back({x, -y, height * std::max(0.0, 1 - from_centre / 0.3)});
      mesh.points.push_back({x, y});
      mesh.fixed_x.push_back(i == 0 || i == n);
      mesh.fixed_y.push_back(j == 0 || j == n);
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  for (const auto& [a, b, c] : mesh.triangles)
    mesh.references.push_back(plane_reference(positions[a], positions[b], positions[c]));
  return mesh;
}

double area_ratio(const PlaneMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return doubled_area(mesh.points[a], mesh.points[b], mesh.points[c]) / (2 * mesh.references[t].area);
}

// E = A (D / V) ((x + 1/x) / 2)^n by the letter.
double energy_by_definition(const PlaneMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const PlaneReference& r = mesh.references[t];
    double D = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const FlatPoint& p = mesh.points[mesh.triangles[t][(k + 1) % 3]];
      const FlatPoint& q = mesh.points[mesh.triangles[t][(k + 2) % 3]];
      D += 0.5 * r.cot[k] * ((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y));
    }
    const double x = area_ratio(mesh, t);
    sum += r.area * D / (2 * r.area * x) * std::pow((x + 1 / x) / 2, mesh.exponent);
  }
  return sum;
}

// The least area ratio of any triangle over the median.
double evenness(const PlaneMesh& mesh) {
  std::vector<double> ratios;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) ratios.push_back(area_ratio(mesh, t));
  std::ranges::sort(ratios);
  return ratios.front() / ratios[ratios.size() / 2];
}

} // namespace

TEST_CASE("the energy is what its formula says, whatever the exponent") {
  PlaneMesh mesh = bump(0.7);
  for (const int exponent : {4, 8, 12, 16}) {
    mesh.exponent = exponent;
    CHECK(energy_of(mesh) == doctest::Approx(energy_by_definition(mesh)).epsilon(1e-9));
  }
}

TEST_CASE("the best scales along the axes cannot be bettered") {
  for (const int exponent : {4, 16}) {
    PlaneMesh mesh = bump(1);
    mesh.exponent = exponent;
    stretch_to_best(mesh);
    const double least = energy_of(mesh);
    for (const auto& [sx, sy] : {std::pair{1.01, 1.0}, {0.99, 1.0}, {1.0, 1.01}, {1.0, 0.99}, {1.01, 0.99}}) {
      PlaneMesh other = mesh;
      for (FlatPoint& p : other.points) p = {sx * p.x, sy * p.y};
      CHECK(energy_of(other) > least);
    }
  }
}

TEST_CASE("relaxation lowers the energy without a fold, and a higher exponent leaves areas more even") {
  double before = 0;
  for (const int exponent : {4, 8, 16}) {
    PlaneMesh mesh = bump(3);
    mesh.exponent = exponent;
    stretch_to_best(mesh);
    double energy = energy_of(mesh);
    for (int round = 0; round < 20; ++round) {
      relax(mesh, 10);
      stretch_to_best(mesh);
      CHECK(energy_of(mesh) <= energy * (1 + 1e-12));
      energy = energy_of(mesh);
    }
    const double now = evenness(mesh);
    CHECK(now > before);
    before = now;
  }
}
