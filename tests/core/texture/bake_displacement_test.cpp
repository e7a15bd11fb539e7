// How far a coarse surface lies from the full one, by the atlas that they share.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "atlas_of.h"
#include "core/texture/bake_displacement.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

// A sphere as the full surface, and the same triangles brought closer to its centre as the coarse one.
struct TwoSpheres {
  SphereMesh mesh = subdivided(icosahedron(), 2);
  CutMesh cut = atlas_of(mesh, 256);
  AtlasPage page{cut, 0};
  std::vector<std::array<Vec3f, 3>> full;
  std::vector<Vec3f> coarse, normals;

  TwoSpheres() {
    std::vector<Vec3f> at;
    for (const CutVertex& v : cut.vertices) {
      const Vec3d p = interpolated(mesh.points, mesh.triangles, v);
      at.emplace_back(p);
      coarse.emplace_back(p * 0.75);
      normals.emplace_back(p);
    }
    for (const orbis::mesh::Triangle& t : cut.triangles) full.push_back({at[t[0]], at[t[1]], at[t[2]]});
  }

  [[nodiscard]] Displacement baked(const CutMesh& shown, std::uint32_t threads = 1) {
    orbis::mesh::ThreadPool pool(threads);
    return bake_displacement(page.map, full, cut.chart, {&page.map, &shown, coarse, normals}, NoProgress(), pool);
  }
};

} // namespace

TEST_CASE("the displacement of a sphere from a smaller one is the difference of their radii, everywhere") {
  TwoSpheres spheres;
  const Displacement d = spheres.baked(spheres.cut);
  CHECK(d.image.channels == 1);
  CHECK(d.image.pixels.size() == std::size_t{d.image.width} * d.image.height);
  const auto [low, high] = std::minmax_element(d.image.pixels.begin(), d.image.pixels.end());
  CHECK(*low == 0);
  CHECK(*high == 65535);
  // In the middle of a triangle the chord is nearer to the centre, by up to 0.03.
  CHECK(d.offset > 0.235);
  CHECK(d.offset + d.scale == doctest::Approx(0.25).epsilon(1e-3));
  CHECK(spheres.baked(spheres.cut, 2).image.pixels == d.image.pixels);
}

TEST_CASE("against the normal a displacement is negative, and without one the triangle's own counts") {
  TwoSpheres spheres;
  for (Vec3f& n : spheres.normals) n = Vec3f{-n.x, -n.y, -n.z};
  const Displacement inward = spheres.baked(spheres.cut);
  CHECK(inward.offset == doctest::Approx(-0.25).epsilon(1e-3));
  CHECK(inward.offset + inward.scale < -0.235);
  for (Vec3f& n : spheres.normals) n = {};
  const Displacement own = spheres.baked(spheres.cut);
  CHECK(own.offset > 0.2);
  CHECK(own.offset + own.scale < 0.2501);
}

TEST_CASE("where the coarse surface has left a component out there is no displacement") {
  TwoSpheres spheres;
  CutMesh other = spheres.cut;
  for (std::uint32_t& chart : other.chart) chart += 100;
  const Displacement d = spheres.baked(other);
  CHECK(d.offset == 0);
  CHECK(d.scale == 0);
  CHECK(std::ranges::all_of(d.image.pixels, [](std::uint16_t n) { return n == 0; }));
}
