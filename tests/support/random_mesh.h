// Random closed meshes, told by a few numbers that can be written down and shrunk.
#pragma once

#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>

#include "support/shapes.h"

namespace orbis::shapes {

// A random triangulation (random splits and flips) with positions of one of several kinds of trouble.
struct RandomMesh {
  std::uint64_t seed = 0;
  std::uint32_t vertices = 4;  // at least 4
  std::uint32_t flips = 0;     // per vertex
  std::uint32_t positions = 0; // 0 random; 1 in a plane; 2 needles, 10^6 long; 3 few distinct ones; 4 denormal; 5 huge

  static constexpr std::uint32_t position_kinds = 6;

  [[nodiscard]] TriangleMesh make() const {
    TriangleMesh m = RandomTriangulation(seed).make(vertices, std::size_t{flips} * vertices);
    std::mt19937_64 random(seed ^ 0x5bd1e995);
    for (Vec3f& p : m.positions) {
      if (positions == 1) p.z = 0;
      if (positions == 2) p.x *= 1e6F;
      if (positions == 3) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
      if (positions == 4) p *= 1e-42F;
      if (positions == 5) p *= 1e30F;
    }
    // A surface without any extent is refused before it gets here.
    if (positions == 3) m.positions[random() % m.positions.size()] += Vec3f{0.5F, 0, 0};
    return m;
  }
  friend std::ostream& operator<<(std::ostream& out, const RandomMesh& m) {
    return out << "seed " << m.seed << ", " << m.vertices << " vertices, " << m.flips << " flips each, positions "
               << m.positions;
  }
};

// A sphere with random smooth bumps, drawn out along its axes: a shape with a best map.
inline TriangleMesh random_blob(std::uint64_t seed, int levels) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  const Vec3f size{std::exp(0.4F * normal(random)), std::exp(0.4F * normal(random)), std::exp(0.4F * normal(random))};
  std::vector<Vec3f> waves;
  for (int i = 0; i < 5; ++i) waves.push_back({2 * normal(random), 2 * normal(random), 2 * normal(random)});
  TriangleMesh m = sphere(levels);
  for (Vec3f& p : m.positions) {
    float radius = 1;
    for (const Vec3f& w : waves) radius += 0.08F * std::sin(dot(w, p) + w.x);
    p = {p.x * radius * size.x, p.y * radius * size.y, p.z * radius * size.z};
  }
  return m;
}

} // namespace orbis::shapes
