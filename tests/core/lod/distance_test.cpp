#include "core/lod/distance.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "core/lod/bumpy_worlds.h"
#include "core/lod/fit_positions.h"
#include "core/lod/samples.h"

using namespace orbis;

namespace {

Vec3d random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  const double x = any(random), y = any(random);
  return {x, y, any(random)};
}

// The nearest of many points of the triangle.
double sampled_distance(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  constexpr int n = 60;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      best = std::min(best, norm(p - t[0] * (1 - u - v) - t[1] * u - t[2] * v));
    }
  return best;
}

lod::Level whole(const lod_tests::World& world) {
  NoProgress progress;
  mesh::ThreadPool pool(0);
  const std::vector<lod::Target> all{{world.cut.triangles.size(), 0}};
  return lod::simplify(world.full(), all, pool, progress).front();
}

} // namespace

TEST_CASE("the distance from a triangle is that of its nearest point") {
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const std::array<Vec3d, 3> t{random_point(random), random_point(random), random_point(random)};
    const Vec3d p = random_point(random) * 2.0;
    const double d = std::sqrt(lod::squared_distance(p, t[0], t[1], t[2])), sampled = sampled_distance(p, t);
    CHECK(d <= sampled + 1e-12);
    CHECK(d >= sampled - 0.05);
  }
}

TEST_CASE("a triangle without area is as far away as the segment or point that it is") {
  const Vec3d a{0, 0, 0}, b{1, 0, 0}, p{0.5, 2, 0};
  CHECK(lod::squared_distance(p, a, b, a) == doctest::Approx(4));
  CHECK(lod::squared_distance(p, a, b, {0.25, 0, 0}) == doctest::Approx(4));
  CHECK(lod::squared_distance(p, a, a, a) == doctest::Approx(4.25));
}

TEST_CASE("the tree finds what a search through all triangles finds") {
  std::mt19937 random(5);
  const mesh::TriangleMesh m = shapes::bumpy_sphere(3);
  const std::vector<Vec3d> positions(m.positions.begin(), m.positions.end());
  const lod::TriangleTree tree(positions, m.triangles);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = random_point(random) * 2.0;
    double best = infinity;
    for (const auto& [a, b, c] : m.triangles)
      best = std::min(best, lod::squared_distance(p, positions[a], positions[b], positions[c]));
    CHECK(tree.squared_distance(p, infinity) == best);
    CHECK(tree.squared_distance(p, best / 2) == best / 2);
  }
}

TEST_CASE("samples are spread by area") {
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 0, 0}, {0, 3, 0}};
  const std::vector<mesh::Triangle> triangles{{0, 1, 2}, {0, 3, 4}};
  const std::vector<lod::Sample> samples = lod::spread_samples(positions, triangles, 1000);
  REQUIRE(samples.size() == 1000);
  std::array<int, 2> count{};
  Vec3d middle;
  for (const lod::Sample& s : samples) {
    ++count[s.triangle];
    CHECK(s.weights[0] >= 0);
    CHECK(s.weights[0] + s.weights[1] + s.weights[2] == doctest::Approx(1));
    if (s.triangle == 1) middle += s.on(positions, triangles);
  }
  CHECK(count[0] == 100);
  CHECK(norm(middle * (1.0 / count[1]) - Vec3d{1, 1, 0}) < 0.02);
}

TEST_CASE("a surface has no distance from itself, and its own distance from a copy that was moved") {
  const lod_tests::World world = lod_tests::bumpy_world(3, 6);
  const lod::FullSurface full = world.full();
  mesh::ThreadPool threads(2), one(1);
  const lod::Ruler ruler(full, threads);
  lod::Level level = whole(world);
  CHECK(ruler.distances(level).hausdorff < 2e-3);
  const Vec3d by{0.1 * full.diagonal(), 0, 0};
  lod::Level moved = level;
  for (Vec3f& p : moved.positions) p = Vec3f(Vec3d(p) + by);
  CHECK(ruler.texture_deviation(moved).mean == doctest::Approx(0.1).epsilon(0.02));
  CHECK(ruler.distances(moved).hausdorff <= 0.1 + 2e-3);
  CHECK(ruler.distances(moved).to_full > 0.01);
  // The same bits with any number of threads.
  const lod::Ruler alone(full, one);
  CHECK(alone.distances(moved).to_full == ruler.distances(moved).to_full);
  CHECK(alone.texture_deviation(moved).mean == ruler.texture_deviation(moved).mean);
}

TEST_CASE("fitted positions are closer to the full surface than those that were shaken") {
  const lod_tests::World world = lod_tests::bumpy_world(4, 8);
  const lod::FullSurface full = world.full();
  NoProgress progress;
  const std::vector<lod::Target> targets{{400, 0}};
  mesh::ThreadPool threads(1);
  lod::Level level = lod::simplify(full, targets, threads, progress).front();
  const lod::Ruler ruler(full, threads);
  const double before = ruler.texture_deviation(level).mean;
  std::mt19937 random(9);
  std::vector<Vec3d> shake(level.mesh.points);
  for (Vec3d& s : shake) s = random_point(random) * (0.002 * full.diagonal());
  for (std::size_t v = 0; v < level.positions.size(); ++v)
    level.positions[v] = Vec3f(Vec3d(level.positions[v]) + shake[level.mesh.vertices[v].point]);
  const double shaken = ruler.texture_deviation(level).mean;
  lod::fit_positions(full, level);
  const double fitted = ruler.texture_deviation(level).mean;
  CHECK(shaken > before);
  CHECK(fitted < shaken);
  CHECK(fitted == doctest::Approx(before).epsilon(0.1));
}
