#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/texture/atlas.h"
#include "core/texture/raster.h"
#include "sphere_meshes.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

constexpr std::uint32_t size = 40;

void count(const std::array<RasterPoint, 3>& corners, std::vector<int>& counts) {
  rasterize(corners, size, size,
            [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>&) { ++counts[y * size + x]; });
}

} // namespace

TEST_CASE("triangles that fill a square cover every texel in it exactly once, whatever their shape and orientation") {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    // A fan around an inner point; in every third round on a texel's centre, where ties must be broken.
    std::uniform_real_distribution<double> coordinate(0.25, size - 0.25);
    RasterPoint inner{coordinate(random), coordinate(random)};
    if (round % 3 == 0) inner = {std::floor(inner.x) + 0.5, std::floor(inner.y) + 0.5};
    const std::vector<RasterPoint> outline{{0, 0},       {size / 2.0, 0}, {size, 0}, {size, 13.5},
                                           {size, size}, {7.25, size},    {0, size}, {0, 0.5}};
    std::vector<int> counts(size * size);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      std::array<RasterPoint, 3> corners{inner, outline[i], outline[(i + 1) % outline.size()]};
      if (random() % 2 == 0) std::swap(corners[1], corners[2]);
      std::rotate(corners.begin(), corners.begin() + random() % 3, corners.end());
      count(corners, counts);
    }
    CHECK(std::all_of(counts.begin(), counts.end(), [](int n) { return n == 1; }));
  }
}

TEST_CASE("weights reproduce the texel's centre, are not negative and add up to 1") {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-20, 60); // parts outside the grid are left out
  for (int round = 0; round < 200; ++round) {
    std::array<RasterPoint, 3> p;
    for (RasterPoint& corner : p) corner = {coordinate(random), coordinate(random)};
    rasterize(p, size, size, [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& w) {
      CHECK(x < size);
      CHECK(y < size);
      CHECK(std::min({w[0], w[1], w[2]}) >= 0);
      CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
      // Corners are rounded to 2^-16, which long thin triangles feel more.
      CHECK(std::abs(w[0] * p[0].x + w[1] * p[1].x + w[2] * p[2].x - (x + 0.5)) < 1e-4);
      CHECK(std::abs(w[0] * p[0].y + w[1] * p[1].y + w[2] * p[2].y - (y + 0.5)) < 1e-4);
    });
  }
}

TEST_CASE("a triangle without area covers nothing") {
  std::vector<int> counts(size * size);
  count({RasterPoint{1, 1}, RasterPoint{20, 20}, RasterPoint{30, 30}}, counts);
  count({RasterPoint{5, 5}, RasterPoint{5, 5}, RasterPoint{9, 2}}, counts);
  CHECK(std::all_of(counts.begin(), counts.end(), [](int n) { return n == 0; }));
}

TEST_CASE("the triangles of a cut sphere cover every texel of the charts exactly once, and nothing else") {
  std::mt19937 random(5);
  const AtlasLayout layout = layout_for(256);
  NoProgress progress;
  for (int round = 0; round < 12; ++round) {
    CAPTURE(round);
    const SphereMesh base = round % 3 == 0 ? tetrahedron() : round % 3 == 1 ? cube() : icosahedron();
    SphereMesh mesh = subdivided(base, round % 5);
    if (round >= 3) mesh = turned(jittered(mesh, 0.5, random), random);
    const CutMesh result = cut(mesh.triangles, mesh.triangles, mesh.grid(), layout, progress);
    std::vector<int> counts(std::size_t{layout.width} * layout.height);
    for (const Triangle& t : result.triangles) {
      std::array<RasterPoint, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = {double(result.vertices[t[k]].uv.x) * layout.width,
                      double(result.vertices[t[k]].uv.y) * layout.height};
      rasterize(corners, layout.width, layout.height,
                [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>&) {
                  ++counts[std::size_t{y} * layout.width + x];
                });
    }
    std::size_t wrong = 0;
    for (std::uint32_t y = 0; y < layout.height; ++y)
      for (std::uint32_t x = 0; x < layout.width; ++x)
        wrong += counts[std::size_t{y} * layout.width + x] != (layout.in_chart(x, y) ? 1 : 0) ? 1 : 0;
    CHECK(wrong == 0);
  }
}
