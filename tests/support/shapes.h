// Small closed meshes, built in code.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::shapes {

using mesh::Index;
using mesh::Triangle;
using mesh::TriangleMesh;

inline TriangleMesh tetrahedron() {
  return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

// Two poles over a ring of n vertices: the poles have valence n.
inline TriangleMesh bipyramid(Index n, float height = 1) {
  TriangleMesh m;
  for (Index i = 0; i < n; ++i) {
    const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
    m.positions.push_back({std::cos(a), std::sin(a), 0});
  }
  m.positions.push_back({0, 0, height});
  m.positions.push_back({0, 0, -height});
  for (Index i = 0; i < n; ++i) {
    m.triangles.push_back({i, (i + 1) % n, n});
    m.triangles.push_back({(i + 1) % n, i, n + 1});
  }
  return m;
}

// Every triangle in four, new vertices at the middles of the edges.
inline TriangleMesh subdivided(const TriangleMesh& m) {
  TriangleMesh out{m.positions, {}};
  std::map<std::pair<Index, Index>, Index> middle;
  const auto between = [&](Index a, Index b) {
    const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(out.positions.size()));
    if (fresh) out.positions.push_back((m.positions[a] + m.positions[b]) * 0.5F);
    return it->second;
  };
  for (const Triangle& t : m.triangles) {
    const Index a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
    out.triangles.insert(out.triangles.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
  }
  return out;
}

// An octahedron, subdivided and pushed out to the unit sphere: 8 * 4^levels triangles.
inline TriangleMesh sphere(int levels) {
  TriangleMesh m = bipyramid(4);
  for (int i = 0; i < levels; ++i) {
    m = subdivided(m);
    for (Vec3f& p : m.positions) p = normalized(p);
  }
  return m;
}

// A sphere with smooth bumps: nothing symmetric about it.
inline TriangleMesh bumpy_sphere(int levels) {
  TriangleMesh m = sphere(levels);
  for (Vec3f& p : m.positions) p *= 1 + 0.4F * std::sin(3 * p.x + 1) * std::cos(4 * p.y) + 0.2F * std::sin(7 * p.z);
  return m;
}

// A sphere pulled to a spike along x that holds most of the area.
inline TriangleMesh spike(int levels, float length) {
  TriangleMesh m = sphere(levels);
  for (Vec3f& p : m.positions) {
    if (p.x > 0.9F) p.x += (p.x - 0.9F) * 10 * length;
  }
  return m;
}

// n by m quads around two circles.
inline TriangleMesh torus(Index n, Index m) {
  TriangleMesh out;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
      const float b = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(m);
      const float r = 2 + std::cos(b);
      out.positions.push_back({r * std::cos(a), r * std::sin(a), std::sin(b)});
      const Index v = i * m + j, right = (i + 1) % n * m + j, up = i * m + (j + 1) % m,
                  both = (i + 1) % n * m + (j + 1) % m;
      out.triangles.push_back({v, right, both});
      out.triangles.push_back({v, both, up});
    }
  }
  return out;
}

// A tube along x, closed by a fan at both ends: rings of `around` vertices.
inline TriangleMesh tube(Index rings, Index around, float length) {
  TriangleMesh out;
  for (Index i = 0; i < rings; ++i) {
    for (Index j = 0; j < around; ++j) {
      const float b = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(around);
      out.positions.push_back(
          {length * static_cast<float>(i) / static_cast<float>(rings - 1), std::cos(b), std::sin(b)});
    }
  }
  const Index left = rings * around, right = left + 1;
  out.positions.push_back({-0.1F, 0, 0});
  out.positions.push_back({length + 0.1F, 0, 0});
  for (Index j = 0; j < around; ++j) {
    const Index k = (j + 1) % around;
    out.triangles.push_back({left, k, j});
    out.triangles.push_back({right, (rings - 1) * around + j, (rings - 1) * around + k});
    for (Index i = 0; i + 1 < rings; ++i) {
      const Index a = i * around + j, b = i * around + k, c = a + around, d = b + around;
      out.triangles.push_back({a, b, d});
      out.triangles.push_back({a, d, c});
    }
  }
  return out;
}

// A random triangulation of the sphere: from a tetrahedron, triangles are split at random and edges flipped at random
// where that makes no double edge. Positions are random too, and mean nothing.
class RandomTriangulation {
public:
  explicit RandomTriangulation(std::uint64_t seed) : random_(seed) {}

  TriangleMesh make(std::size_t vertices, std::size_t flips) {
    TriangleMesh m = tetrahedron();
    std::normal_distribution<float> coordinate;
    while (m.positions.size() < vertices) {
      const std::size_t t = random_() % m.triangles.size();
      const auto v = static_cast<Index>(m.positions.size());
      m.positions.push_back({coordinate(random_), coordinate(random_), coordinate(random_)});
      const Triangle old = m.triangles[t];
      m.triangles[t] = {old[0], old[1], v};
      m.triangles.push_back({old[1], old[2], v});
      m.triangles.push_back({old[2], old[0], v});
    }
    for (std::size_t i = 0; i < flips; ++i) flip(m);
    return m;
  }

private:
  void flip(TriangleMesh& m) {
    if (edges_.empty()) {
      for (std::uint32_t t = 0; t < m.triangles.size(); ++t) add(m, t);
    }
    const auto t = static_cast<std::uint32_t>(random_() % m.triangles.size());
    const std::size_t k = random_() % 3;
    const Index a = m.triangles[t][k], b = m.triangles[t][(k + 1) % 3], c = m.triangles[t][(k + 2) % 3];
    const std::uint32_t s = edges_.at({b, a});
    Index d = 0;
    for (const Index v : m.triangles[s]) {
      if (v != a && v != b) d = v;
    }
    if (c == d || edges_.contains({c, d}) || edges_.contains({d, c})) return;
    remove(m, t);
    remove(m, s);
    m.triangles[t] = {a, d, c};
    m.triangles[s] = {d, b, c};
    add(m, t);
    add(m, s);
  }
  void add(const TriangleMesh& m, std::uint32_t t) {
    for (std::size_t k = 0; k < 3; ++k) edges_[{m.triangles[t][k], m.triangles[t][(k + 1) % 3]}] = t;
  }
  void remove(const TriangleMesh& m, std::uint32_t t) {
    for (std::size_t k = 0; k < 3; ++k) edges_.erase({m.triangles[t][k], m.triangles[t][(k + 1) % 3]});
  }

  std::mt19937_64 random_;
  std::map<std::pair<Index, Index>, std::uint32_t> edges_;
};

} // namespace orbis::shapes
