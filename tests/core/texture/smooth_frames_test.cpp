#include "core/texture/smooth_frames.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "atlas_of.h"

using namespace orbis;
using namespace orbis::texture;

namespace {

// The sphere's own frames on its atlas: normals outward, and tangents without a pole inside a chart.
struct Globe {
  CutMesh cut = sphere_meshes::atlas_of(sphere_meshes::subdivided(sphere_meshes::octahedron(), 5), 256);
  sphere_meshes::AtlasPage page{cut, 0};
  std::vector<Vec3f> normals;
  std::vector<Tangent> tangents;

  Globe() : normals(cut.vertices.size()), tangents(cut.vertices.size()) {
    std::vector<Vec3d> middles(cut.charts.size());
    for (std::size_t t = 0; t < cut.triangles.size(); ++t)
      for (const mesh::Index v : cut.triangles[t]) middles[cut.chart[t]] += normal_at(v);
    for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
      const Vec3d& m = middles[cut.chart[t]];
      const Vec3d axis = cross(m, std::abs(m.y) < norm(m) / 2 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0});
      for (const mesh::Index v : cut.triangles[t]) {
        const Vec3d n = normal_at(v), along = normalized(cross(axis, n));
        normals[v] = Vec3f(n);
        tangents[v] = {static_cast<float>(along.x), static_cast<float>(along.y), static_cast<float>(along.z), -1};
      }
    }
  }
  [[nodiscard]] Vec3d normal_at(mesh::Index v) const {
    return normalized(Vec3d(sphere::from_grid(cut.vertices[v].sphere)));
  }
  [[nodiscard]] std::vector<std::uint32_t> charts() const {
    std::vector<std::uint32_t> out(cut.charts.size());
    std::iota(out.begin(), out.end(), 0U);
    return out;
  }
  [[nodiscard]] FrameField field() const { return {&page.map, cut.triangles, normals, tangents}; }
};

Vec3d direction(const Tangent& t) { return {double{t.x}, double{t.y}, double{t.z}}; }

} // namespace

TEST_CASE("smooth frames are frames, lean the way the surface does, and keep its handedness") {
  const Globe globe;
  const std::vector<std::uint32_t> charts = globe.charts();
  const SmoothFrames smooth(globe.cut, charts, globe.field());
  for (std::size_t t = 0; t < globe.cut.triangles.size(); ++t) {
    for (const mesh::Index v : globe.cut.triangles[t]) {
      const VertexFrame frame = smooth.at(globe.cut.chart[t], globe.cut.vertices[v].uv);
      const Vec3d n(frame.normal), tangent = direction(frame.tangent);
      CHECK(norm(n) == doctest::Approx(1).epsilon(1e-6));
      CHECK(norm(tangent) == doctest::Approx(1).epsilon(1e-6));
      CHECK(std::abs(dot(n, tangent)) < 1e-6);
      CHECK(frame.tangent.w == -1);
      CHECK(dot(n, Vec3d(globe.normals[v])) > 0.8);
    }
  }
}

TEST_CASE("what lies between two places of a chart is what interpolation gives, closer the nearer they are") {
  const Globe globe;
  const std::vector<std::uint32_t> charts = globe.charts();
  const SmoothFrames smooth(globe.cut, charts, globe.field());
  const Chart& chart = globe.cut.charts[0];
  const Page& page = globe.cut.pages[0];
  const auto at = [&](double x, double y) {
    return smooth.at(0, {static_cast<float>((chart.x + x * chart.width) / page.width),
                         static_cast<float>((chart.y + y * chart.height) / page.height)});
  };
  const auto worst = [&](double step) {
    double off = 0;
    for (double x = 0; x + step <= 1; x += step) {
      const VertexFrame a = at(x, 0.3), b = at(x + step, 0.3), between = at(x + step / 2, 0.3);
      off = std::max(off, norm(normalized(Vec3d(a.normal) + Vec3d(b.normal)) - Vec3d(between.normal)));
      off = std::max(off, norm(normalized(direction(a.tangent) + direction(b.tangent)) - direction(between.tangent)));
    }
    return off;
  };
  CHECK(worst(1.0 / 8) < 0.02);
  CHECK(worst(1.0 / 32) < worst(1.0 / 8) / 4);
}

TEST_CASE("where the surface's normals cancel out, the frames are still frames") {
  Globe globe;
  for (std::size_t v = 0; v < globe.normals.size(); ++v)
    globe.normals[v] = v % 2 == 0 ? Vec3f{0, 0, 1} : Vec3f{0, 0, -1};
  const std::vector<std::uint32_t> charts = globe.charts();
  const SmoothFrames smooth(globe.cut, charts, globe.field());
  for (std::size_t t = 0; t < globe.cut.triangles.size(); ++t) {
    const VertexFrame frame = smooth.at(globe.cut.chart[t], globe.cut.vertices[globe.cut.triangles[t][0]].uv);
    CHECK(norm(Vec3d(frame.normal)) == doctest::Approx(1).epsilon(1e-6));
    CHECK(std::abs(dot(Vec3d(frame.normal), direction(frame.tangent))) < 1e-6);
  }
}
