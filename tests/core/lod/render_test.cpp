#include "core/lod/render.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/lod/bumpy_worlds.h"
#include "core/lod/normal_map.h"
#include "core/lod/simplify.h"
#include "core/texture/shape.h"

using namespace orbis;

namespace {

struct Studio {
  explicit Studio(const lod_tests::World& world_, std::uint32_t threads_ = 1)
      : world(world_), full(world.full()), normals(texture::smooth_normals(world.cut, full.positions())),
        threads(threads_), map(full, normals), positions(positions_of(full)),
        photographer({positions, world.cut.triangles, lod::interpolated(normals, world.cut.triangles)}, 128, threads) {}

  static std::vector<Vec3f> positions_of(const lod::FullSurface& full) {
    std::vector<Vec3f> out;
    for (const Vec3d& p : full.positions()) out.push_back(full.in_model(p));
    return out;
  }

  [[nodiscard]] double psnr_with_map(const lod::Level& level) const {
    return photographer.psnr({level.positions, level.mesh.triangles, map.on(level.mesh)});
  }
  [[nodiscard]] double psnr_without_map(const lod::Level& level) const {
    const std::vector<Vec3d> at(level.positions.begin(), level.positions.end());
    const std::vector<Vec3d> own = texture::smooth_normals(level.mesh, at);
    return photographer.psnr({level.positions, level.mesh.triangles, lod::interpolated(own, level.mesh.triangles)});
  }
  [[nodiscard]] lod::Level level(std::uint64_t triangles) const {
    NoProgress progress;
    mesh::ThreadPool pool(0);
    const std::vector<lod::Target> targets{{triangles, 0}};
    return lod::simplify(full, targets, pool, progress).front();
  }

  const lod_tests::World& world;
  lod::FullSurface full;
  std::vector<Vec3d> normals;
  mesh::ThreadPool threads;
  lod::NormalMap map;
  std::vector<Vec3f> positions;
  lod::Photographer photographer;
};

} // namespace

TEST_CASE("the normal map gives back the normals that went into it, also at the charts' borders") {
  const lod_tests::World world = lod_tests::bumpy_world(4, 1);
  const Studio studio(world);
  std::vector<Vec3d> normals; // smooth ones: those of the sphere
  for (const texture::CutVertex& v : world.cut.vertices)
    normals.push_back(normalized(Vec3d(sphere::from_grid(v.sphere))));
  const lod::NormalMap map(studio.full, normals);
  double worst = 0, mean = 0;
  for (std::size_t v = 0; v < world.cut.vertices.size(); ++v) {
    const Vec2f uv = world.cut.vertices[v].uv;
    const Vec3d n = normalized(map.at({uv.x, uv.y}, 0));
    const double off = std::acos(std::min(1.0, dot(n, normals[v])));
    worst = std::max(worst, off);
    mean += off / static_cast<double>(world.cut.vertices.size());
  }
  CHECK(mean < 0.01);
  CHECK(worst < 0.05);
}

TEST_CASE("more triangles look more like the full surface, and the normal map helps where they are few") {
  const lod_tests::World world = lod_tests::bumpy_world(5, 2);
  const Studio studio(world);
  const lod::Level fine = studio.level(3000), coarse = studio.level(300);
  CHECK(studio.psnr_with_map(fine) > studio.psnr_with_map(coarse));
  CHECK(studio.psnr_with_map(coarse) > studio.psnr_without_map(coarse));
  CHECK(studio.psnr_with_map(coarse) > 20);
}

TEST_CASE("a picture shows the surface in its middle and nothing in its corners, from every side") {
  const lod_tests::World world = lod_tests::bumpy_world(3, 3);
  const Studio studio(world);
  for (std::size_t view = 0; view < lod::Photographer::views; ++view) {
    const lod::Picture picture = studio.photographer.of_full(view);
    REQUIRE(picture.light.size() == std::size_t{128} * 128);
    CHECK(picture.light[64 * 128 + 64] > 0.1F);
    CHECK(picture.light[0] == lod::background);
    CHECK(picture.light.back() == lod::background);
  }
}

TEST_CASE("the pictures' difference does not depend on the number of threads") {
  const lod_tests::World world = lod_tests::bumpy_world(3, 4);
  const Studio one(world, 1), three(world, 3);
  const lod::Level level = one.level(100);
  CHECK(one.psnr_with_map(level) == three.psnr_with_map(level));
}
