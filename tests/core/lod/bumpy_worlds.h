// Bumpy surfaces over the sphere, cut for the atlas: what levels of detail start from.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/lod/full_surface.h"
#include "core/texture/atlas.h"
#include "support/shapes.h"

namespace orbis::lod_tests {

struct World {
  mesh::TriangleMesh surface;
  std::vector<std::uint32_t> primitive_of;
  texture::CutMesh cut;

  [[nodiscard]] lod::FullSurface full() const { return {surface, primitive_of, cut}; }
};

inline std::uint32_t material_at(const Vec3d& p, std::uint32_t materials) {
  if (materials == 2) return p.z > 0 ? 1 : 0;
  const auto patch = [](double x) { return static_cast<std::uint32_t>(std::floor(2 * (x + 2))); };
  return (patch(p.x) + 3 * patch(p.y) + 5 * patch(p.z)) % materials;
}

// A bumpy sphere of 8 * 4^subdivisions triangles. The map is its projection to the sphere, turned at random; the
// northern half is of another material where `materials` is 2; more lie in patches with ragged borders.
inline World bumpy_world(int subdivisions, std::uint32_t seed, std::uint32_t materials = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0.5, 3.0);
  const std::array<double, 4> frequency{any(random), any(random), any(random), any(random)};
  World world;
  world.surface = shapes::sphere(subdivisions);
  const Vec3d axis = normalized(Vec3d{any(random), any(random), any(random)});
  std::vector<sphere::GridPoint> grid;
  for (Vec3f& p : world.surface.positions) {
    const Vec3d s(p);
    // Rodrigues' rotation by one radian: the atlas' borders pass through triangles, not along them.
    grid.push_back(sphere::to_grid(std::cos(1.0) * s + std::sin(1.0) * cross(axis, s) +
                                   (1 - std::cos(1.0)) * dot(axis, s) * axis));
    p = Vec3f(s * (1 + 0.15 * std::sin(4 * frequency[0] * s.x + frequency[1]) * std::cos(4 * frequency[2] * s.y) +
                   0.08 * std::sin(9 * s.z * frequency[3])));
  }
  for (const mesh::Triangle& t : world.surface.triangles)
    world.primitive_of.push_back(material_at(Vec3d(world.surface.positions[t[0]]), materials));
  // Vertices of their own for each material, as a file has them.
  std::vector<mesh::Triangle> corners = world.surface.triangles;
  const auto count = static_cast<mesh::Index>(world.surface.positions.size());
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (mesh::Index& v : corners[t]) v += world.primitive_of[t] * count;
  NoProgress progress;
  world.cut = texture::make_atlas(
      {world.surface.triangles, corners, grid, world.surface.positions, world.surface.triangles.size()}, 512, progress);
  return world;
}

// Without the triangles of its cut around the north pole and around a place at the equator: a rim with corners, and
// another one.
inline World punctured(World world) {
  texture::CutMesh& cut = world.cut;
  std::size_t left = 0;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    const Vec3d p = normalized(Vec3d(world.surface.positions[world.surface.triangles[cut.parent[t]][0]]));
    if (p.z > 0.8 || p.x > 0.95) continue;
    cut.triangles[left] = cut.triangles[t];
    cut.parent[left] = cut.parent[t];
    cut.chart[left++] = cut.chart[t];
  }
  cut.triangles.resize(left);
  cut.parent.resize(left);
  cut.chart.resize(left);
  return world;
}

// Two worlds side by side, the second scaled and far enough away; one cut after the other.
inline World pair_of(World a, const World& b, double scale) {
  const auto vertices = static_cast<mesh::Index>(a.surface.positions.size());
  const auto triangles = static_cast<std::uint32_t>(a.surface.triangles.size());
  const auto cut_vertices = static_cast<mesh::Index>(a.cut.vertices.size());
  // Points that are welded vertices come first in each cut: they keep their order only within their own world.
  const auto points = static_cast<std::uint32_t>(a.cut.points);
  for (const Vec3f& p : b.surface.positions) a.surface.positions.emplace_back(Vec3d(p) * scale + Vec3d{5, 0, 0});
  for (const auto& [i, j, k] : b.surface.triangles)
    a.surface.triangles.push_back({i + vertices, j + vertices, k + vertices});
  a.primitive_of.insert(a.primitive_of.end(), b.primitive_of.begin(), b.primitive_of.end());
  for (texture::CutVertex v : b.cut.vertices) {
    v.triangle += triangles;
    v.point += points;
    a.cut.vertices.push_back(v);
  }
  for (const auto& [i, j, k] : b.cut.triangles)
    a.cut.triangles.push_back({i + cut_vertices, j + cut_vertices, k + cut_vertices});
  for (const std::uint32_t parent : b.cut.parent) a.cut.parent.push_back(parent + triangles);
  const auto charts = static_cast<std::uint32_t>(a.cut.charts.size());
  for (const std::uint32_t chart : b.cut.chart) a.cut.chart.push_back(charts + chart);
  a.cut.charts.insert(a.cut.charts.end(), b.cut.charts.begin(), b.cut.charts.end());
  a.cut.points += b.cut.points;
  return a;
}

} // namespace orbis::lod_tests
