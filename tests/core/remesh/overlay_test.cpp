#include "core/remesh/overlay.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/remesh/polyhedron.h"

using namespace orbis;

namespace {

using Corners = std::array<Vec3d, 3>;

Corners corners_of(const remesh::SphereMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.points[a], mesh.points[b], mesh.points[c]};
}

Vec3d at(const Corners& corners, const std::array<double, 3>& w) {
  return corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
}

double share(const std::vector<remesh::OverlayCorner>& part) {
  double area = 0;
  for (std::size_t i = 2; i < part.size(); ++i) {
    const auto &a = part[0].on_target, &b = part[i - 1].on_target, &c = part[i].on_target;
    area += (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  }
  return area;
}

// Turned, so that no edge lies on another.
remesh::SphereMesh turned(remesh::SphereMesh mesh) {
  for (Vec3d& p : mesh.points)
    p = normalized(Vec3d{0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, p.z} + Vec3d{0, 0, 0.1});
  return mesh;
}

} // namespace

TEST_CASE("the parts that one triangulation cuts out of another's triangle fill it") {
  const auto target = remesh::subdivided(RemeshTarget::Base::icosahedral, 1);
  for (const std::uint32_t times : {0U, 1U, 3U}) {
    const auto source = turned(remesh::subdivided(RemeshTarget::Base::octahedral, times));
    for (std::size_t t = 0; t < target.triangles.size(); ++t) {
      double whole = 0;
      for (std::size_t s = 0; s < source.triangles.size(); ++s)
        whole += share(remesh::common_part(corners_of(source, s), corners_of(target, t)));
      CHECK(whole == doctest::Approx(1).epsilon(1e-9));
    }
  }
}

TEST_CASE("a corner of a part is one point of the sphere, on the source as on the target") {
  const auto target = remesh::subdivided(RemeshTarget::Base::icosahedral, 1);
  const auto source = turned(remesh::subdivided(RemeshTarget::Base::octahedral, 2));
  int parts = 0;
  for (std::size_t t = 0; t < target.triangles.size(); ++t) {
    for (std::size_t s = 0; s < source.triangles.size(); ++s) {
      const auto part = remesh::common_part(corners_of(source, s), corners_of(target, t));
      parts += part.empty() ? 0 : 1;
      for (const remesh::OverlayCorner& corner : part) {
        const Vec3d p = normalized(at(corners_of(source, s), corner.on_source));
        const Vec3d q = normalized(at(corners_of(target, t), corner.on_target));
        CHECK(norm(p - q) < 1e-13);
        for (std::size_t k = 0; k < 3; ++k) {
          CHECK(corner.on_target[k] >= 0);
          CHECK(corner.on_source[k] > -1e-12);
        }
      }
    }
  }
  CHECK(parts > 300);
}

TEST_CASE("triangles on opposite sides of the sphere have nothing in common") {
  const auto mesh = remesh::subdivided(RemeshTarget::Base::octahedral, 0);
  CHECK(remesh::common_part(corners_of(mesh, 0), corners_of(mesh, 6)).empty());
  CHECK(share(remesh::common_part(corners_of(mesh, 0), corners_of(mesh, 1))) == doctest::Approx(0));
  CHECK(share(remesh::common_part(corners_of(mesh, 3), corners_of(mesh, 3))) == doctest::Approx(1));
}

TEST_CASE("in the atlas the source covers what the target covers, on any number of threads") {
  // The target in an atlas of its own: each triangle a cell of a grid, as big as any other.
  const auto target = remesh::subdivided(RemeshTarget::Base::icosahedral, 2);
  texture::CutMesh cut;
  std::vector<Vec3d> directions;
  for (std::size_t t = 0; t < target.triangles.size(); ++t) {
    const auto first = static_cast<mesh::Index>(cut.vertices.size());
    const auto x = static_cast<float>(t % 32) / 32, y = static_cast<float>(t / 32) / 32;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = target.points[target.triangles[t][k]];
      const Vec2f uv{x + (k == 1 ? 1.0F / 32 : 0), y + (k == 2 ? 1.0F / 32 : 0)};
      std::array<double, 3> corner{};
      corner[k] = 1;
      cut.vertices.push_back({static_cast<std::uint32_t>(t), corner, sphere::to_grid(p), uv, first});
      directions.push_back(p);
    }
    cut.triangles.push_back({first, first + 1, first + 2});
    cut.parent.push_back(static_cast<std::uint32_t>(t));
    cut.chart.push_back(0);
  }
  cut.charts.resize(1);
  cut.pages.push_back({256, 256});

  const auto source = turned(remesh::subdivided(RemeshTarget::Base::octahedral, 3));
  const remesh::OverlayPair pair{source.points, source.triangles, 100, 0,
                                 static_cast<std::uint32_t>(cut.triangles.size())};
  mesh::ThreadPool one(1), three(3);
  const texture::CutMesh out = remesh::overlay(cut, directions, std::span(&pair, 1), one);
  double area = 0;
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    const Vec2f &a = out.vertices[out.triangles[t][0]].uv, &b = out.vertices[out.triangles[t][1]].uv,
                &c = out.vertices[out.triangles[t][2]].uv;
    area += (double{b.x} - a.x) * (double{c.y} - a.y) - (double{c.x} - a.x) * (double{b.y} - a.y);
    CHECK(out.parent[t] >= 100);
    CHECK(out.parent[t] < 100 + source.triangles.size());
  }
  CHECK(area == doctest::Approx(static_cast<double>(target.triangles.size()) / 1024).epsilon(1e-5));

  const texture::CutMesh again = remesh::overlay(cut, directions, std::span(&pair, 1), three);
  CHECK(again.triangles == out.triangles);
  CHECK(again.parent == out.parent);
}
