// What the atlas' certificate proves, and what it finds.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "atlas_of.h"
#include "core/texture/atlas_certificate.h"
#include "core/texture/quality.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

CutMesh bumpy_atlas() {
  std::mt19937 random(41);
  return atlas_of(turned(jittered(subdivided(icosahedron(), 3), 0.4, random), random), 512);
}

} // namespace

TEST_CASE("atlases of any sphere mesh are certified, chart by chart, in exact arithmetic") {
  std::mt19937 random(42);
  for (int round = 0; round < 20; ++round) {
    CAPTURE(round);
    const SphereMesh base = round % 3 == 0 ? tetrahedron() : round % 3 == 1 ? cube() : icosahedron();
    const AtlasCertificate c = certify_atlas(atlas_of(turned(subdivided(base, round % 5), random), 256));
    CHECK_MESSAGE(c.valid, c.failure());
    CHECK(c.closed_charts == 6);
    CHECK(c.open_charts == 0);
  }
}

TEST_CASE("a vertex that moves over its neighbours is found") {
  CutMesh mesh = bumpy_atlas();
  const Triangle t = mesh.triangles[100];
  std::swap(mesh.vertices[t[0]].uv, mesh.vertices[t[1]].uv);
  const AtlasCertificate c = certify_atlas(mesh);
  CHECK_FALSE(c.valid);
  CHECK(c.folded > 0);
}

TEST_CASE("coordinates between the grid's points, or none at all, are found") {
  for (const float value : {1.0F / 3, NAN, -1.0F, 2.0F}) {
    CutMesh mesh = bumpy_atlas();
    mesh.vertices[7].uv.x = value;
    CHECK(certify_atlas(mesh).off_grid == 1);
  }
}

TEST_CASE("charts that come too close, or leave their rectangle, are found") {
  CutMesh mesh = bumpy_atlas();
  mesh.charts[0].x = mesh.charts[1].x;
  mesh.charts[0].y = mesh.charts[1].y;
  const AtlasCertificate c = certify_atlas(mesh);
  CHECK(c.too_close > 0);
  CHECK(c.outside > 0);
}

TEST_CASE("a surface that covers its chart twice is found, though no triangle is folded") {
  CutMesh mesh = bumpy_atlas();
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) { // the same again, as other points
    Triangle copy{};
    for (std::size_t k = 0; k < 3; ++k) {
      CutVertex v = mesh.vertices[mesh.triangles[t][k]];
      v.point += static_cast<std::uint32_t>(mesh.points);
      copy[k] = static_cast<Index>(mesh.vertices.size());
      mesh.vertices.push_back(v);
    }
    mesh.triangles.push_back(copy);
    mesh.parent.push_back(mesh.parent[t]);
    mesh.chart.push_back(mesh.chart[t]);
  }
  const AtlasCertificate c = certify_atlas(mesh);
  CHECK(c.folded == 0);
  CHECK(c.not_filled == 6);
}

TEST_CASE("with a hole, a chart is open and its texels are counted") {
  CutMesh mesh = bumpy_atlas();
  mesh.triangles.erase(mesh.triangles.begin() + 50);
  mesh.parent.erase(mesh.parent.begin() + 50);
  mesh.chart.erase(mesh.chart.begin() + 50);
  const AtlasCertificate c = certify_atlas(mesh);
  CHECK_MESSAGE(c.valid, c.failure());
  CHECK(c.open_charts == 1);
  mesh.triangles.push_back(mesh.triangles[10]);
  mesh.parent.push_back(mesh.parent[10]);
  mesh.chart.push_back(mesh.chart[10]);
  CHECK_FALSE(certify_atlas(mesh).valid);
}

TEST_CASE("texels follow the surface: on a body with a long limb the first percentile keeps half of the median") {
  const SphereMesh sphere = subdivided(icosahedron(), 5);
  mesh::TriangleMesh body;
  for (const Vec3d& p : sphere.points)
    body.positions.emplace_back(p * (1 + 2.5 * std::exp(-20 * squared_norm(p - Vec3d{0.6, 0.64, 0.48}))));
  body.triangles = sphere.triangles;
  const std::vector<GridPoint> grid = sphere.grid();
  NoProgress progress;
  const CutMesh mesh =
      make_atlas({body.triangles, body.triangles, grid, body.positions, body.triangles.size()}, 1024, progress);
  const AtlasQuality quality = measure_atlas(mesh, body);
  CHECK(quality.density_p1 > 0.5 * quality.density_median);
  CHECK(quality.density_min > 0);
  CHECK(quality.seam_length < 7.7);
  CHECK(quality.l2_stretch < 1.3);
}

TEST_CASE("what closes a hole takes no texels from the surface around it") {
  const SphereMesh sphere = subdivided(icosahedron(), 4);
  mesh::TriangleMesh shell;
  // A deep shell with a wide mouth.
  for (const Vec3d& p : sphere.points) shell.positions.emplace_back(Vec3d{p.x, p.y, 3 * p.z});
  const auto closes_hole = [&](const mesh::Triangle& t) { return sphere.points[t[0]].z > 0.1; };
  shell.triangles = sphere.triangles;
  std::ranges::stable_partition(shell.triangles, std::not_fn(closes_hole));
  const auto delivered = static_cast<std::size_t>(std::ranges::count_if(shell.triangles, std::not_fn(closes_hole)));
  const std::vector<GridPoint> grid = sphere.grid();
  NoProgress progress;
  const CutMesh mesh = make_atlas({shell.triangles, shell.triangles, grid, shell.positions, delivered}, 1024, progress);
  const AtlasQuality quality = measure_atlas(mesh, shell);
  CHECK(quality.density_p1 > 0.75 * quality.density_median);
  CHECK(quality.l2_stretch < 1.1);

  // Charts are the rectangles around what is delivered, but for room to move by some units of the grid.
  std::vector<double> left(mesh.charts.size(), 1e9), right(left.size()), top(left), bottom(left.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Page& page = mesh.pages[mesh.page_of(t)];
    for (const mesh::Index v : mesh.triangles[t]) {
      const double x = double{mesh.vertices[v].uv.x} * page.width, y = double{mesh.vertices[v].uv.y} * page.height;
      const std::uint32_t c = mesh.chart[t];
      left[c] = std::min(left[c], x);
      right[c] = std::max(right[c], x);
      top[c] = std::min(top[c], y);
      bottom[c] = std::max(bottom[c], y);
    }
  }
  double texels = 0;
  for (std::size_t c = 0; c < mesh.charts.size(); ++c) {
    CHECK(right[c] - left[c] >= 0.96 * mesh.charts[c].width);
    CHECK(bottom[c] - top[c] >= 0.96 * mesh.charts[c].height);
    texels += static_cast<double>(mesh.charts[c].width) * mesh.charts[c].height;
  }
  // What is used is what triangles cover, not their charts.
  CHECK(utilisation(mesh) * mesh.pages[0].width * mesh.pages[0].height < texels);
}

TEST_CASE("the sphere itself has the cube's seams, an even density and hardly any stretch") {
  const SphereMesh sphere = subdivided(icosahedron(), 4);
  mesh::TriangleMesh surface{{}, sphere.triangles};
  for (const Vec3d& p : sphere.points) surface.positions.emplace_back(p);
  const AtlasQuality quality = measure_atlas(atlas_of(sphere, 1024), surface);
  // Twelve arcs of acos(1/3) over the root of 4 pi.
  CHECK(quality.seam_length == doctest::Approx(12 * std::acos(1.0 / 3) / std::sqrt(4 * 3.14159265)).epsilon(0.01));
  CHECK(quality.density_p1 > 0.9 * quality.density_median);
  CHECK(quality.l2_stretch < 1.03);
}
