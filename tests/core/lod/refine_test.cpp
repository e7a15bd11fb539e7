// What the last touch must do to every level, and what it must leave as it is.
#include "core/lod/refine.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/lod/bumpy_worlds.h"
#include "core/lod/distance.h"

using namespace orbis;
using lod_tests::bumpy_world;
using lod_tests::World;

namespace {

lod::Level level_of(const lod::FullSurface& full, std::uint64_t triangles) {
  NoProgress progress;
  const std::vector<lod::Target> targets{{triangles, 0}};
  mesh::ThreadPool pool(0);
  return lod::simplify(full, targets, pool, progress).front();
}

std::vector<std::uint32_t> copies_of_points(const lod::Level& level) {
  std::vector<std::uint32_t> copies(level.mesh.points);
  for (const texture::CutVertex& v : level.mesh.vertices) ++copies[v.point];
  return copies;
}

// Moves the points that have one vertex by up to `by`, in the model's units.
void shake(lod::Level& level, double by, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-by, by);
  const std::vector<std::uint32_t> copies = copies_of_points(level);
  for (std::size_t v = 0; v < level.positions.size(); ++v) {
    const Vec3d off{any(random), any(random), any(random)};
    if (copies[level.mesh.vertices[v].point] == 1) level.positions[v] = Vec3f(Vec3d(level.positions[v]) + off);
  }
}

double energy_of(lod::Draft& draft) {
  double sum = 0;
  const std::vector<mesh::Triangle>& triangles = draft.level().mesh.triangles;
  std::vector<lod::Held> held;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    draft.collect(std::array{t}, held);
    sum += draft.energy(held, std::span(triangles).subspan(t, 1));
  }
  return sum;
}

bool is_sound(const lod::Draft& draft, int sign) {
  const std::vector<mesh::Triangle>& triangles = draft.level().mesh.triangles;
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const mesh::Triangle& t) { return draft.is_sound(t, sign); });
}

// Every edge between two points has two triangles.
bool is_closed_manifold(const lod::Level& level) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const mesh::Triangle& t : level.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[std::minmax(level.mesh.vertices[t[k]].point, level.mesh.vertices[t[(k + 1) % 3]].point)];
  return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 2; });
}

} // namespace

TEST_CASE("a level that was shaken comes back to the full surface, with as many triangles") {
  for (const std::uint32_t seed : {1U, 2U}) {
    CAPTURE(seed);
    const World world = bumpy_world(4, seed);
    const lod::FullSurface full = world.full();
    mesh::ThreadPool threads(1);
    const lod::Ruler ruler(full, threads);
    lod::Level level = level_of(full, 400);
    const double before = ruler.texture_deviation(level).mean;
    shake(level, 0.07, seed);
    const double shaken = ruler.texture_deviation(level).mean;
    REQUIRE(shaken > 1.5 * before);
    lod::refine(full, level, NoProgress{});
    CHECK(ruler.texture_deviation(level).mean < 1.1 * before);
    CHECK(ruler.texture_deviation(level).outside == 0);
    CHECK(level.mesh.triangles.size() <= 400);
  }
}

TEST_CASE("each step lowers the deviation, folds nothing and keeps the surface closed") {
  const World world = bumpy_world(4, 3);
  const lod::FullSurface full = world.full();
  lod::Level level = level_of(full, 300);
  shake(level, 0.03, 3);
  lod::Draft draft(full, level);
  const int sign = draft.atlas_orientation(level.mesh.triangles[0]);
  REQUIRE(is_sound(draft, sign));
  const double shaken = energy_of(draft);

  lod::relocate(draft, NoProgress{});
  const double moved = energy_of(draft);
  CHECK(moved < 0.5 * shaken);
  CHECK(is_sound(draft, sign));

  const std::vector<mesh::Triangle> triangles = level.mesh.triangles;
  lod::flip_edges(draft);
  CHECK(triangles != level.mesh.triangles);
  CHECK(energy_of(draft) < moved);
  CHECK(is_sound(draft, sign));
  CHECK(is_closed_manifold(level));
}

TEST_CASE("what lies on the borders of charts and materials keeps its place in the atlas") {
  const World world = bumpy_world(4, 5, 2);
  const lod::FullSurface full = world.full();
  lod::Level level = level_of(full, 500);
  shake(level, 0.02, 5);
  const std::vector<texture::CutVertex> before = level.mesh.vertices;
  const std::vector<std::uint32_t> copies = copies_of_points(level);
  lod::refine(full, level, NoProgress{});
  std::size_t moved = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const texture::CutVertex& after = level.mesh.vertices[v];
    CHECK(after.point == before[v].point);
    if (copies[after.point] > 1) CHECK(after.uv == before[v].uv);
    moved += after.uv == before[v].uv ? 0 : 1;
  }
  CHECK(moved > 0);
}

TEST_CASE("the full surface itself is left alone") {
  const World world = bumpy_world(3, 6);
  const lod::FullSurface full = world.full();
  lod::Level level = level_of(full, world.cut.triangles.size());
  REQUIRE(level.mesh.triangles.size() == world.cut.triangles.size());
  const std::vector<Vec3f> positions = level.positions;
  lod::refine(full, level, NoProgress{});
  CHECK(level.positions == positions);
}
