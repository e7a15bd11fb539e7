// Open components as one chart: outlines, corners, edges across, and when cuts are better.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "atlas_of.h"
#include "core/texture/atlas_certificate.h"
#include "core/texture/disk_chart.h"
#include "core/texture/flat_charts.h"
#include "core/texture/outline.h"
#include "core/texture/place.h"
#include "core/texture/quality.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

using Triangle = orbis::mesh::Triangle;

// A sphere of which some triangles are an open surface, in space where `to_space` takes it, and the others close it.
struct OpenSurface {
  orbis::mesh::TriangleMesh mesh;
  std::vector<GridPoint> grid;
  std::size_t delivered = 0;

  OpenSurface(const SphereMesh& sphere, const std::function<bool(const Vec3d& centre)>& is_delivered,
              const std::function<Vec3d(const Vec3d&)>& to_space)
      : grid(sphere.grid()) {
    for (const Vec3d& p : sphere.points) mesh.positions.emplace_back(to_space(p));
    mesh.triangles = sphere.triangles;
    const auto end = std::stable_partition(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      return is_delivered((sphere.points[t[0]] + sphere.points[t[1]] + sphere.points[t[2]]) * (1 / 3.0));
    });
    delivered = static_cast<std::size_t>(end - mesh.triangles.begin());
  }

  [[nodiscard]] AtlasComponent component() const {
    return {mesh.triangles, std::span(mesh.triangles).first(delivered), grid, mesh.positions, delivered};
  }
  [[nodiscard]] CutMesh atlas() const {
    NoProgress progress;
    orbis::mesh::ThreadPool pool(1);
    const AtlasComponent whole = component();
    const FlatCharts charts = lay_flat(whole, ChartKinds::all, progress, pool);
    Placed placed = place(std::span(&whole, 1), std::span(&charts, 1), {.width = 512});
    REQUIRE(placed.folded.empty());
    return std::move(placed.mesh);
  }
};

// From the north pole to a plane, and what is there between the sphere's pole in the south and this height.
Vec3d stereographic(const Vec3d& p) { return Vec3d{p.x, -p.y, 0} * (1 / std::max(1 - p.z, 0.1)); }

std::function<bool(const Vec3d&)> below(double height) {
  return [height](const Vec3d& p) { return p.z < height; };
}

double surface_in(const CutMesh& mesh, const std::vector<Vec3f>& positions, std::span<const Triangle> triangles) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = interpolated(positions, triangles, mesh.vertices[t[k]]);
    area += 0.5 * norm(cross(p[1] - p[0], p[2] - p[0]));
  }
  return area;
}

// A square of n x n cells on the lower part of a sphere, and cells around it that close it.
OpenSurface square_sheet(std::uint32_t n, double width) {
  SphereMesh sphere;
  const std::uint32_t row = n + 1;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x)
      sphere.points.push_back(normalized(Vec3d{2.0 * x / n - 1, 1 - 2.0 * y / n, -1}));
  const auto pole = static_cast<mesh::Index>(sphere.points.size());
  sphere.points.emplace_back(0, 0, 1);
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const mesh::Index a = y * row + x, b = a + 1, c = a + row, d = c + 1;
      sphere.triangles.push_back({a, b, c});
      sphere.triangles.push_back({b, d, c});
    }
  const std::size_t inner = sphere.triangles.size();
  for (std::uint32_t i = 0; i < n; ++i) {
    sphere.triangles.push_back({i + 1, i, pole});
    sphere.triangles.push_back({i * row, (i + 1) * row, pole});
    sphere.triangles.push_back({n * row + i, n * row + i + 1, pole});
    sphere.triangles.push_back({(i + 1) * row + n, i * row + n, pole});
  }
  OpenSurface out(
      sphere, [](const Vec3d&) { return true; },
      [width](const Vec3d& p) {
        return Vec3d{-width * p.x / p.z, -p.y / p.z, 0};
      });
  out.mesh.positions.back() = {0, 0, 1};
  out.delivered = inner;
  return out;
}

} // namespace

TEST_CASE("a flat rectangle fills its page, without a cut and without distortion") {
  for (const double width : {1.0, 2.0, 5.0, 40.0}) {
    const OpenSurface sheet = square_sheet(6, width);
    const CutMesh mesh = sheet.atlas();
    CHECK(mesh.charts.size() == 1);
    const AtlasQuality quality = measure_atlas(mesh, sheet.mesh);
    CHECK(quality.l2_stretch == doctest::Approx(1).epsilon(0.01));
    CHECK(quality.density_min > 0.97);
    CHECK(quality.seam_length == 0);
    if (width < 10) CHECK(utilisation(mesh) > 0.95); // no page is lower than 64 texels
    const AtlasCertificate certificate = certify_atlas(mesh);
    CHECK_MESSAGE(certificate.valid, certificate.failure());
    CHECK(certificate.closed_charts == 1);
  }
}

TEST_CASE("the corners of an outline are found where it turns") {
  const OpenSurface sheet = square_sheet(8, 3);
  const AtlasComponent component = sheet.component();
  const std::optional<Disk> disk = as_disk(component);
  REQUIRE(disk.has_value());
  CHECK(disk->outline.size() == 32);
  const Corners corners = corners_of(*disk, component, 1).front();
  for (const std::size_t i : corners) {
    const Vec3f& p = sheet.mesh.positions[disk->outline[i]];
    CHECK(std::abs(p.x) == doctest::Approx(3));
    CHECK(std::abs(p.y) == doctest::Approx(1));
  }
}

TEST_CASE("the corners do not depend on where the outline begins") {
  // The same rectangle with its vertices and triangles in other orders.
  std::mt19937 random(5);
  for (int round = 0; round < 10; ++round) {
    OpenSurface sheet = square_sheet(10, 2);
    std::vector<mesh::Index> number(sheet.grid.size());
    std::iota(number.begin(), number.end(), 0U);
    std::shuffle(number.begin(), number.end(), random);
    const OpenSurface before = sheet;
    for (std::size_t v = 0; v < number.size(); ++v) {
      sheet.grid[number[v]] = before.grid[v];
      sheet.mesh.positions[number[v]] = before.mesh.positions[v];
    }
    for (Triangle& t : sheet.mesh.triangles)
      for (mesh::Index& v : t) v = number[v];
    std::shuffle(sheet.mesh.triangles.begin(),
                 sheet.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(sheet.delivered), random);
    const AtlasQuality quality = measure_atlas(sheet.atlas(), sheet.mesh);
    CHECK(quality.l2_stretch < 1.005);
    CHECK(quality.density_min > 0.97);
  }
}

TEST_CASE("steep cells stay rectangular: the layout begins with their own shapes") {
  OpenSurface sheet = square_sheet(12, 1);
  // One row of cells in the middle is sixty times as long as the others.
  for (Vec3f& p : sheet.mesh.positions)
    if (p.y > 0.01F) p.y += 10;
  const CutMesh mesh = sheet.atlas();
  CHECK(mesh.charts.size() == 1);
  CHECK(measure_atlas(mesh, sheet.mesh).l2_stretch < 1.05);
}

TEST_CASE("a single triangle is one chart") {
  SphereMesh sphere = tetrahedron();
  const OpenSurface one(
      sphere,
      [&](const Vec3d& p) {
        const auto& [a, b, c] = sphere.triangles[2];
        return norm(p - (sphere.points[a] + sphere.points[b] + sphere.points[c]) * (1 / 3.0)) < 1e-9;
      },
      [](const Vec3d& p) { return p; });
  REQUIRE(one.delivered == 1);
  const CutMesh mesh = one.atlas();
  CHECK(mesh.charts.size() == 1);
  CHECK(mesh.triangles.size() == 2);
  CHECK(certify_atlas(mesh).valid);
  CHECK(utilisation(mesh) > 0.9);
}

TEST_CASE("a round disk is one chart; a deep cup is cut") {
  const SphereMesh sphere = subdivided(icosahedron(), 4);
  const OpenSurface disk(sphere, below(0), stereographic);
  const CutMesh flat = disk.atlas();
  CHECK(flat.charts.size() == 1);
  CHECK(measure_atlas(flat, disk.mesh).l2_stretch < 1.15);
  CHECK(utilisation(flat) > 0.95);
  CHECK(certify_atlas(flat).valid);

  const OpenSurface cup(sphere, below(0.9), [](const Vec3d& p) { return p; });
  CHECK(as_disk(cup.component())->openness < 0.2);
  CHECK(cup.atlas().charts.size() > 1);
  const OpenSurface closed(
      sphere, [](const Vec3d&) { return true; }, [](const Vec3d& p) { return p; });
  CHECK_FALSE(as_disk(closed.component()).has_value());
}

TEST_CASE("a disk with a hole keeps the hole inside its chart") {
  const SphereMesh sphere = subdivided(icosahedron(), 4);
  const OpenSurface ring(
      sphere,
      [](const Vec3d& p) {
        return p.z < 0 && norm(p - Vec3d{0.3, 0.2, -0.93}) > 0.2;
      },
      stereographic);
  const CutMesh mesh = ring.atlas();
  CHECK(mesh.charts.size() == 1);
  const AtlasCertificate certificate = certify_atlas(mesh);
  CHECK_MESSAGE(certificate.valid, certificate.failure());
  CHECK(certificate.open_charts == 1);
  for (const std::uint32_t parent : mesh.parent) CHECK(parent < ring.delivered);
}

TEST_CASE("ragged patches: ears and edges across are laid out without a fold, and the surface is all there") {
  const SphereMesh sphere = subdivided(icosahedron(), 3);
  int disks = 0, divided = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(0, 1);
    const double edge = 0.6 * part(random) - 0.8, raggedness = 0.5 * part(random);
    const OpenSurface patch(
        sphere, [&](const Vec3d& p) { return p.z < edge + raggedness * part(random); }, stereographic);
    if (patch.delivered == 0) continue;
    const AtlasComponent component = patch.component();
    const std::optional<Disk> disk = as_disk(component);
    if (!disk || disk->outline.size() < 4) continue;
    const std::optional<FlatCharts> chart = cut_to_disk(component, *disk, corners_of(*disk, component, 1).front());
    if (!chart) continue;
    ++disks;
    divided += chart->mesh.cut_triangles > 0 ? 1 : 0;
    CHECK(chart->mesh.charts.size() == 1);
    const CutMesh mesh = patch.atlas();
    const AtlasCertificate certificate = certify_atlas(mesh);
    CHECK_MESSAGE(certificate.valid, seed, ": ", certificate.failure());
    const std::span<const Triangle> delivered = std::span(patch.mesh.triangles).first(patch.delivered);
    double area = 0;
    for (const auto& [a, b, c] : delivered) {
      const Vec3d p(patch.mesh.positions[a]), q(patch.mesh.positions[b]), r(patch.mesh.positions[c]);
      area += 0.5 * norm(cross(q - p, r - p));
    }
    CHECK(surface_in(mesh, patch.mesh.positions, patch.mesh.triangles) == doctest::Approx(area).epsilon(1e-6));
  }
  CHECK(disks >= 10);
  CHECK(divided >= 5);
}
