// Small meshes with something about them: open, with handles, one-sided, joined where they should not be.
#pragma once

#include "support/shapes.h"

namespace orbis::shapes {

inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh out = a;
  const auto first = static_cast<Index>(a.positions.size());
  out.positions.insert(out.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles) out.triangles.push_back({first + i, first + j, first + k});
  return out;
}

inline TriangleMesh moved(TriangleMesh m, const Vec3f& by) {
  for (Vec3f& p : m.positions) p += by;
  return m;
}

// A grid of n by m quads over [0, n] x [0, m], wavy in z.
inline TriangleMesh terrain(Index n, Index m, float height = 0) {
  TriangleMesh out;
  for (Index i = 0; i <= n; ++i) {
    for (Index j = 0; j <= m; ++j) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      out.positions.push_back({x, y, height * std::sin(0.7F * x) * std::cos(0.9F * y)});
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const Index v = i * (m + 1) + j, right = v + m + 1;
      out.triangles.push_back({v, right, right + 1});
      out.triangles.push_back({v, right + 1, v + 1});
    }
  }
  return out;
}

// The terrain without the quads whose numbers in both directions are odd.
inline TriangleMesh holed_terrain(Index n, Index m) {
  TriangleMesh out = terrain(n, m, 0.5F);
  std::vector<Triangle> kept;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      if (i % 2 == 1 && j % 2 == 1) continue;
      const std::size_t t = 2 * (std::size_t{i} * m + j);
      kept.insert(kept.end(), {out.triangles[t], out.triangles[t + 1]});
    }
  }
  out.triangles = kept;
  return out;
}

// A disk of triangles around a centre, rings of n vertices.
inline TriangleMesh disk(Index rings, Index n) {
  TriangleMesh out{{{0, 0, 0}}, {}};
  for (Index r = 1; r <= rings; ++r) {
    for (Index i = 0; i < n; ++i) {
      const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
      out.positions.push_back({static_cast<float>(r) * std::cos(a), static_cast<float>(r) * std::sin(a), 0});
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    out.triangles.push_back({0, 1 + i, 1 + j});
    for (Index r = 1; r < rings; ++r) {
      const Index a = 1 + (r - 1) * n + i, b = 1 + (r - 1) * n + j;
      out.triangles.push_back({a, a + n, b + n});
      out.triangles.push_back({a, b + n, b});
    }
  }
  return out;
}

inline TriangleMesh annulus(Index rings, Index n) {
  TriangleMesh out = disk(rings, n);
  std::erase_if(out.triangles, [](const Triangle& t) { return t[0] == 0; });
  return out;
}

// A strip of n quads, `wide` of them across, once around with `half_turns` half turns: 1 is a Moebius strip.
inline TriangleMesh strip(Index n, Index wide, int half_turns) {
  TriangleMesh out;
  for (Index i = 0; i < n; ++i) {
    const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
    const float b = a * static_cast<float>(half_turns) / 2;
    for (Index j = 0; j <= wide; ++j) {
      const float w = static_cast<float>(j) / static_cast<float>(wide) - 0.5F, r = 2 + w * std::cos(b);
      out.positions.push_back({r * std::cos(a), r * std::sin(a), w * std::sin(b)});
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < wide; ++j) {
      const bool last = i + 1 == n, flip = last && half_turns % 2 != 0;
      const auto at = [&](Index row, Index k) {
        if (row < n) return row * (wide + 1) + k;
        return flip ? wide - k : k;
      };
      const Index a = at(i, j), b = at(i, j + 1), c = at(i + 1, j), d = at(i + 1, j + 1);
      out.triangles.push_back({a, c, d});
      out.triangles.push_back({a, d, b});
    }
  }
  return out;
}

// The Klein bottle as a figure of eight that turns over once on its way around, n by m quads: it runs through itself,
// but no two vertices meet.
inline TriangleMesh klein_bottle(Index n, Index m) {
  TriangleMesh out;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const float u = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
      const float v = 2 * std::numbers::pi_v<float> * (static_cast<float>(j) + 0.25F) / static_cast<float>(m);
      const float r = 3 + std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v);
      out.positions.push_back(
          {r * std::cos(u), r * std::sin(u), std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)});
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      // After one round sin(v) and sin(2 v) change their signs: v becomes minus v.
      const auto at = [&](Index row, Index k) {
        k %= m;
        return row < n ? row * m + k : (2 * m - 1 - k) % m;
      };
      const Index a = at(i, j), b = at(i, j + 1), c = at(i + 1, j), d = at(i + 1, j + 1);
      out.triangles.push_back({a, c, d});
      out.triangles.push_back({a, d, b});
    }
  }
  return out;
}

// The surface of a set of unit cubes, faces between two of them left out: cubes that touch in an edge or a corner share
// its vertices.
inline TriangleMesh voxels(const std::vector<std::array<int, 3>>& cubes) {
  TriangleMesh out;
  std::map<std::array<int, 3>, Index> vertex;
  const auto at = [&](const std::array<int, 3>& p) {
    const auto [it, fresh] = vertex.try_emplace(p, static_cast<Index>(out.positions.size()));
    if (fresh) out.positions.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    return it->second;
  };
  for (const std::array<int, 3>& c : cubes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> beyond = c;
        beyond[axis] += side == 1 ? 1 : -1;
        if (std::find(cubes.begin(), cubes.end(), beyond) != cubes.end()) continue;
        std::array<int, 3> p = c, u{}, v{};
        p[axis] += side;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        const auto corner = [&](int i, int j) {
          return at({p[0] + i * u[0] + j * v[0], p[1] + i * u[1] + j * v[1], p[2] + i * u[2] + j * v[2]});
        };
        Index a = corner(0, 0), b = corner(1, 0), d = corner(1, 1), e = corner(0, 1);
        if (side == 0) std::swap(b, e);
        out.triangles.push_back({a, b, d});
        out.triangles.push_back({a, d, e});
      }
    }
  }
  return out;
}

// A plate of (2 n + 1) by 3 cubes with n square holes: genus n.
inline TriangleMesh plate_with_holes(int n) {
  std::vector<std::array<int, 3>> cubes;
  for (int x = 0; x < 2 * n + 1; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x % 2 == 0 || y != 1) cubes.push_back({x, y, 0});
    }
  }
  return voxels(cubes);
}

// Every triangle with vertices of its own.
inline TriangleMesh soup(const TriangleMesh& m) {
  TriangleMesh out;
  for (const Triangle& t : m.triangles) {
    const auto first = static_cast<Index>(out.positions.size());
    for (const Index v : t) out.positions.push_back(m.positions[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

// Two flat grids that meet along x = 0, the right one twice as fine: every second of its vertices there lies in the
// middle of one of the left one's edges.
inline TriangleMesh t_junction_grid(Index n) {
  TriangleMesh left = terrain(n, n), right = terrain(2 * n, 2 * n);
  for (Vec3f& p : left.positions) p.x -= static_cast<float>(n);
  for (Vec3f& p : right.positions) p = {p.x / 2, p.y / 2, p.z};
  return joined(left, right);
}

} // namespace orbis::shapes
