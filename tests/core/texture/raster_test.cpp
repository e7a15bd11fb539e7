#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "atlas_of.h"
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
  for (int round = 0; round < 12; ++round) {
    CAPTURE(round);
    const SphereMesh base = round % 3 == 0 ? tetrahedron() : round % 3 == 1 ? cube() : icosahedron();
    SphereMesh mesh = subdivided(base, round % 5);
    if (round >= 3) mesh = turned(jittered(mesh, 0.5, random), random);
    const CutMesh result = atlas_of(mesh, 256);
    const Page& page = result.pages[0];
    std::vector<std::uint32_t> expected(std::size_t{page.width} * page.height, 0), counts = expected;
    for (const Chart& chart : result.charts)
      for (std::uint32_t y = chart.y; y < chart.y + chart.height; ++y)
        for (std::uint32_t x = chart.x; x < chart.x + chart.width; ++x) ++expected[std::size_t{y} * page.width + x];
    rasterize_page(result, [&](std::uint32_t x, std::uint32_t y, std::uint32_t t, const std::array<double, 3>&) {
      const Chart& chart = result.charts[result.chart[t]];
      CHECK((x - chart.x < chart.width && y - chart.y < chart.height)); // no other chart's texel
      ++counts[std::size_t{y} * page.width + x];
    });
    CHECK(counts == expected);
  }
}
