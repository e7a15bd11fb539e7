// Triangulations of the sphere for tests: regular solids, subdivided, turned and jittered, on the grid.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sphere/orientation.h"
#include "core/vec3.h"

namespace sphere_meshes {

using orbis::Vec3d;
using orbis::mesh::Index;
using orbis::mesh::Triangle;
using orbis::sphere::GridPoint;

struct SphereMesh {
  std::vector<Vec3d> points;
  std::vector<Triangle> triangles;

  [[nodiscard]] std::vector<GridPoint> grid() const {
    std::vector<GridPoint> result(points.size());
    std::transform(points.begin(), points.end(), result.begin(), orbis::sphere::to_grid);
    return result;
  }
  [[nodiscard]] bool positive() const {
    const auto g = grid();
    return std::all_of(triangles.begin(), triangles.end(),
                       [&](const Triangle& t) { return orbis::sphere::orientation(g[t[0]], g[t[1]], g[t[2]]) == 1; });
  }
};

// The convex hull's faces, outward: fine for a few points in general or symmetric position.
inline SphereMesh solid(std::vector<Vec3d> points) {
  for (Vec3d& p : points) p = normalized(p);
  SphereMesh mesh{std::move(points), {}};
  const auto n = static_cast<Index>(mesh.points.size());
  for (Index a = 0; a < n; ++a)
    for (Index b = a + 1; b < n; ++b)
      for (Index c = a + 1; c < n; ++c) {
        if (b == c) continue;
        const Vec3d normal = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
        const bool hull = std::all_of(mesh.points.begin(), mesh.points.end(),
                                      [&](const Vec3d& p) { return dot(normal, p - mesh.points[a]) < 1e-9; });
        if (hull) mesh.triangles.push_back({a, b, c});
      }
  return mesh;
}

inline SphereMesh tetrahedron() { return solid({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}); }
inline SphereMesh octahedron() { return solid({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}); }
inline SphereMesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  return solid({{0, 1, g},
                {0, 1, -g},
                {0, -1, g},
                {0, -1, -g},
                {1, g, 0},
                {1, -g, 0},
                {-1, g, 0},
                {-1, -g, 0},
                {g, 0, 1},
                {-g, 0, 1},
                {g, 0, -1},
                {-g, 0, -1}});
}
// The cube's corners, each face split by a diagonal: every edge lies on a border of the atlas or inside a face.
inline SphereMesh cube() {
  SphereMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.push_back(normalized(Vec3d((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1)));
  mesh.triangles = {{1, 3, 7}, {1, 7, 5}, {0, 4, 6}, {0, 6, 2}, {2, 6, 7}, {2, 7, 3},
                    {0, 1, 5}, {0, 5, 4}, {4, 5, 7}, {4, 7, 6}, {0, 2, 3}, {0, 3, 1}};
  return mesh;
}

// Each triangle into four.
inline SphereMesh subdivided(const SphereMesh& mesh, int times) {
  if (times == 0) return mesh;
  SphereMesh fine{mesh.points, {}};
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(fine.points.size()));
    if (is_new) fine.points.push_back(normalized(mesh.points[a] + mesh.points[b]));
    return entry->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return subdivided(fine, times - 1);
}

// Braces fix the order of the three numbers; an argument list would leave it to the compiler.
inline Vec3d random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

// Rotates all points about a random axis by a random angle.
inline SphereMesh turned(SphereMesh mesh, std::mt19937& random) {
  const Vec3d x = normalized(random_vector(random));
  const Vec3d z = normalized(cross(x, random_vector(random)));
  const Vec3d y = cross(z, x);
  for (Vec3d& p : mesh.points) p = x * p.x + y * p.y + z * p.z;
  return mesh;
}

// Moves each vertex at random as far as its triangles allow, `fraction` of the way: slivers come with 1.
inline SphereMesh jittered(SphereMesh mesh, double fraction, std::mt19937& random) {
  std::vector<std::vector<std::size_t>> star(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t]) star[v].push_back(t);
  const auto valid = [&](std::size_t v) {
    return std::all_of(star[v].begin(), star[v].end(), [&](std::size_t t) {
      const auto& [a, b, c] = mesh.triangles[t];
      using orbis::sphere::to_grid;
      return orbis::sphere::orientation(to_grid(mesh.points[a]), to_grid(mesh.points[b]), to_grid(mesh.points[c])) == 1;
    });
  };
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Vec3d before = mesh.points[v];
    const Vec3d direction = random_vector(random);
    double step = fraction;
    mesh.points[v] = normalized(before + direction * step);
    while (!valid(v)) {
      step /= 2;
      mesh.points[v] = step > 1e-7 ? normalized(before + direction * step) : before;
    }
  }
  return mesh;
}

} // namespace sphere_meshes
