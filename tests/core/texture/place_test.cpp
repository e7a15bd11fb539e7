// Where charts go: pages, density, gutters.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "atlas_of.h"
#include "core/texture/flat_charts.h"
#include "core/texture/place.h"
#include "core/texture/skyline.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

// Spheres of several sizes, each a component, on pages by turns.
struct Spheres {
  SphereMesh mesh = subdivided(icosahedron(), 1);
  std::vector<GridPoint> grid = mesh.grid();
  std::vector<std::vector<Vec3f>> positions;
  std::vector<AtlasComponent> components;
  std::vector<FlatCharts> charts;

  Spheres(const std::vector<double>& radii, std::uint32_t pages) {
    NoProgress progress;
    orbis::mesh::ThreadPool pool(1);
    for (const double radius : radii) {
      positions.emplace_back();
      for (const Vec3d& p : mesh.points) positions.back().emplace_back(p * radius);
    }
    for (std::uint32_t i = 0; i < radii.size(); ++i) {
      components.push_back({mesh.triangles, mesh.triangles, grid, positions[i], mesh.triangles.size(),
                            i * static_cast<std::uint32_t>(grid.size()),
                            i * static_cast<std::uint32_t>(mesh.triangles.size()), i % pages});
      charts.push_back(lay_flat(components.back(), ChartKinds::faces, progress, pool));
    }
  }
};

bool overlap(const Chart& a, const Chart& b, std::uint32_t gap) {
  return a.page == b.page && a.x < b.x + b.width + gap && b.x < a.x + a.width + gap && a.y < b.y + b.height + gap &&
         b.y < a.y + a.height + gap;
}

std::vector<double> radii_of(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.3, 3);
  std::vector<double> radii(count);
  for (double& r : radii) r = radius(random);
  return radii;
}

} // namespace

TEST_CASE("rectangles are packed without overlap, inside their page, and close together") {
  std::mt19937 random(31);
  std::uniform_int_distribution<std::uint32_t> side(20, 60);
  for (int round = 0; round < 20; ++round) {
    std::vector<Extent> rectangles(200);
    std::uint64_t area = 0;
    for (Extent& r : rectangles) {
      r = {side(random), side(random)};
      area += std::uint64_t{r.width} * r.height;
    }
    const auto edge = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(area) / 0.85));
    const auto places = pack(rectangles, {edge, edge});
    REQUIRE(places.has_value());
    std::vector<int> covered(std::size_t{edge} * edge);
    for (std::size_t i = 0; i < rectangles.size(); ++i) {
      const auto [x, y, turned] = (*places)[i];
      const std::uint32_t width = turned ? rectangles[i].height : rectangles[i].width;
      const std::uint32_t height = turned ? rectangles[i].width : rectangles[i].height;
      REQUIRE(x + width <= edge);
      REQUIRE(y + height <= edge);
      for (std::uint32_t v = y; v < y + height; ++v)
        for (std::uint32_t u = x; u < x + width; ++u) ++covered[std::size_t{v} * edge + u];
    }
    CHECK(*std::max_element(covered.begin(), covered.end()) == 1);
  }
  CHECK_FALSE(pack(std::vector<Extent>{{10, 10}, {10, 10}}, {15, 15}).has_value());
  CHECK(pack(std::vector<Extent>{{30, 5}}, {5, 30}).has_value()); // turned
}

TEST_CASE("charts keep their gutters apart, use four fifths of their pages and have one density") {
  std::mt19937 random(32);
  for (const std::size_t count : {1U, 2U, 7U, 40U}) {
    CAPTURE(count);
    const Spheres spheres(radii_of(count, random), 1);
    const auto [mesh, folded, density] = place(spheres.components, spheres.charts, {.width = 2048});
    CHECK(folded.empty());
    REQUIRE(mesh.pages.size() == 1);
    CHECK(mesh.pages[0].width == 2048);
    CHECK(mesh.charts.size() == 6 * count);
    CHECK(utilisation(mesh) > 0.8);
    double least = 1e9, most = 0; // texels per area
    for (std::size_t i = 0; i < mesh.charts.size(); ++i) {
      const Chart& chart = mesh.charts[i];
      CHECK(chart.x + chart.width <= mesh.pages[0].width);
      CHECK(chart.y + chart.height <= mesh.pages[0].height);
      for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(overlap(chart, mesh.charts[j], 2 * mesh.gutter));
      const FlatCharts::Size& size = spheres.charts[i / 6].sizes[i % 6];
      const double own = chart.width * chart.height / (size.width * size.height);
      least = std::min(least, own);
      most = std::max(most, own);
    }
    CHECK(most / least < 1.1);
  }
}

TEST_CASE("pages share one density: where there is less surface, the page is smaller") {
  std::mt19937 random(33);
  const Spheres spheres(radii_of(9, random), 3);
  const auto [mesh, folded, density] = place(spheres.components, spheres.charts, {.width = 1024});
  CHECK(folded.empty());
  REQUIRE(mesh.pages.size() == 3);
  std::uint32_t widest = 0;
  for (const Page& page : mesh.pages) {
    widest = std::max(widest, page.width);
    CHECK(page.width % 4 == 0);
    CHECK(page.height % 4 == 0);
  }
  CHECK(widest == 1024);
  for (const Chart& c : mesh.charts) CHECK(c.page == c.component % 3);
  CHECK(utilisation(mesh) > 0.75);
}

TEST_CASE("a texel density that is asked for is given, on pages as small as they can be") {
  std::mt19937 random(17);
  const Spheres spheres(radii_of(7, random), 3);
  std::uint64_t last = 0;
  for (const double asked : {4.0, 20.0, 100.0}) {
    CAPTURE(asked);
    const auto [mesh, folded, density] = place(spheres.components, spheres.charts, {.texel_density = asked});
    CHECK(folded.empty());
    CHECK(density == asked);
    // Charts are as large as the surface, on average, and whole texels of at least two.
    double texels = 0, area = 0;
    for (const Chart& c : mesh.charts) texels += static_cast<double>(c.width) * c.height;
    for (const FlatCharts& charts : spheres.charts)
      for (const FlatCharts::Size& size : charts.sizes) area += size.width * size.height;
    CHECK(std::sqrt(texels / area) == doctest::Approx(asked).epsilon(asked < 10 ? 0.2 : 0.03));
    std::uint64_t all = 0;
    for (const Page& page : mesh.pages) all += std::uint64_t{page.width} * page.height;
    CHECK(all > last);
    last = all;
    if (asked > 10) CHECK(utilisation(mesh) > 0.6);
  }
}

TEST_CASE("a texel density that the widest page cannot hold is lowered to what it can") {
  const Spheres spheres({1.0}, 1);
  const auto [mesh, folded, density] = place(spheres.components, spheres.charts, {.texel_density = 1e6});
  CHECK(mesh.pages.at(0).width == widest_page);
  CHECK(density < 1e6);
  CHECK(density > 1000);
}

TEST_CASE("an atlas outside 64 to 8192 texels, or with more charts than it can hold, is refused by the option's name") {
  const Spheres spheres(std::vector<double>(30, 1.0), 1);
  for (const std::uint32_t size : {0U, 63U, 8193U, 64U}) try {
      (void)place(spheres.components, spheres.charts, {.width = size});
      FAIL("accepted");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalid_option);
      CHECK(e.where() == "texture_size");
    }
}

TEST_CASE("triangles that only close a hole are not delivered, and their charts get no texels") {
  Spheres whole({1}, 1);
  AtlasComponent open = whole.components[0];
  // Everything above z = 0.7 only closes a hole.
  std::stable_partition(whole.mesh.triangles.begin(), whole.mesh.triangles.end(), [&](const Triangle& t) {
    return whole.mesh.points[t[0]].z + whole.mesh.points[t[1]].z + whole.mesh.points[t[2]].z < 0.3;
  });
  open.triangles = whole.mesh.triangles;
  open.delivered = static_cast<std::size_t>(
      std::count_if(whole.mesh.triangles.begin(), whole.mesh.triangles.end(), [&](const Triangle& t) {
        return whole.mesh.points[t[0]].z + whole.mesh.points[t[1]].z + whole.mesh.points[t[2]].z < 0.3;
      }));
  open.corners = std::span(whole.mesh.triangles).first(open.delivered);
  NoProgress progress;
  mesh::ThreadPool pool(1);
  const FlatCharts charts = lay_flat(open, ChartKinds::faces, progress, pool);
  const CutMesh mesh = place(std::span(&open, 1), std::span(&charts, 1), {.width = 512}).mesh;
  CHECK(mesh.charts.size() == 5);
  for (const std::uint32_t parent : mesh.parent) CHECK(parent < open.delivered);
}
