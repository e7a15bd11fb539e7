// The low-resolution models of the paper's table 1, rebuilt: the paper shows them and gives their triangle counts.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::test {

// The surface of a set of unit cubes, each side cut into `cuts` x `cuts` squares of two triangles.
inline mesh::TriangleMesh cube_complex(const std::vector<std::array<int, 3>>& cells, int cuts) {
  const std::set<std::array<int, 3>> solid(cells.begin(), cells.end());
  mesh::TriangleMesh out;
  std::map<std::array<int, 3>, mesh::Index> vertex_at;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, fresh] = vertex_at.try_emplace(at, static_cast<mesh::Index>(out.positions.size()));
    if (fresh) {
      const auto coordinate = [&](int i) { return static_cast<float>(i) / static_cast<float>(cuts); };
      out.positions.emplace_back(coordinate(at[0]), coordinate(at[1]), coordinate(at[2]));
    }
    return it->second;
  };
  for (const auto& cell : solid) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        std::array<int, 3> beyond = cell;
        beyond[axis] += side == 1 ? 1 : -1;
        if (solid.contains(beyond)) continue;
        // u, v and the outward normal make a right-handed system.
        const std::size_t u = (axis + (side == 1 ? 1 : 2)) % 3, v = (axis + (side == 1 ? 2 : 1)) % 3;
        for (int i = 0; i < cuts; ++i) {
          for (int j = 0; j < cuts; ++j) {
            const auto corner = [&](int du, int dv) {
              std::array<int, 3> at{cell[0] * cuts, cell[1] * cuts, cell[2] * cuts};
              at[axis] += side * cuts;
              at[u] += i + du;
              at[v] += j + dv;
              return vertex(at);
            };
            const mesh::Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
            out.triangles.push_back({a, b, c});
            out.triangles.push_back({a, c, d});
          }
        }
      }
    }
  }
  return out;
}

// One circle of vertices about the z axis.
struct Circle {
  int sectors;
  float radius, height;
};

// A surface of revolution about z from the bottom up, closed by one vertex at each end. Neighbouring circles may
// differ in their number of sectors: the strip between them always steps along the one that lags behind.
inline mesh::TriangleMesh lathe(float bottom, const std::vector<Circle>& circles, float top) {
  mesh::TriangleMesh out;
  std::vector<mesh::Index> first;
  out.positions.emplace_back(0.0F, 0.0F, bottom);
  for (const Circle& c : circles) {
    first.push_back(static_cast<mesh::Index>(out.positions.size()));
    for (int k = 0; k < c.sectors; ++k) {
      const double angle = 2 * std::numbers::pi * k / c.sectors;
      out.positions.emplace_back(c.radius * static_cast<float>(std::cos(angle)),
                                 c.radius * static_cast<float>(std::sin(angle)), c.height);
    }
  }
  const auto apex = static_cast<mesh::Index>(out.positions.size());
  out.positions.emplace_back(0.0F, 0.0F, top);
  const auto at = [&](std::size_t circle, int k) {
    return first[circle] + static_cast<mesh::Index>(k % circles[circle].sectors);
  };
  for (int k = 0; k < circles.front().sectors; ++k) out.triangles.push_back({0, at(0, k + 1), at(0, k)});
  for (std::size_t c = 0; c + 1 < circles.size(); ++c) {
    const int n = circles[c].sectors, m = circles[c + 1].sectors;
    for (int i = 0, j = 0; i < n || j < m;) {
      if (j == m || (i < n && (i + 1) * m <= (j + 1) * n)) {
        out.triangles.push_back({at(c, i), at(c, i + 1), at(c + 1, j)});
        ++i;
      } else {
        out.triangles.push_back({at(c, i), at(c + 1, j + 1), at(c + 1, j)});
        ++j;
      }
    }
  }
  for (int k = 0; k < circles.back().sectors; ++k)
    out.triangles.push_back({apex, at(circles.size() - 1, k), at(circles.size() - 1, k + 1)});
  return out;
}

// 300 triangles: a cube with 5 x 5 squares on each side.
inline mesh::TriangleMesh cube5() { return cube_complex({{0, 0, 0}}, 5); }

// 134 triangles: a ball of five circles of 11 vertices on a stick of three circles of 4.
inline mesh::TriangleMesh lollypop() {
  std::vector<Circle> circles;
  for (int i = 0; i < 3; ++i) circles.push_back({4, 0.12F, static_cast<float>(i) / 3});
  for (int i = 1; i <= 5; ++i) {
    const double angle = std::numbers::pi * i / 6; // from the ball's south pole
    circles.push_back({11, static_cast<float>(std::sin(angle)), static_cast<float>(2 - std::cos(angle))});
  }
  return lathe(0.0F, circles, 3.0F);
}

// 280 triangles: six square arms on a unit cube, cut across into five bands (the four level ones) or six (up and down),
// each closed by four triangles about the middle of its end.
inline mesh::TriangleMesh cross() {
  constexpr float band = 0.4F;
  mesh::TriangleMesh out;
  for (int k = 0; k < 8; ++k)
    out.positions.emplace_back(k & 1 ? 0.5F : -0.5F, k & 2 ? 0.5F : -0.5F, k & 4 ? 0.5F : -0.5F);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      // The corners of the cube's side, counter-clockwise seen from the arm's end.
      const std::size_t u = (axis + (side == 1 ? 1 : 2)) % 3, v = (axis + (side == 1 ? 2 : 1)) % 3;
      const auto corner = [&](std::size_t on_u, std::size_t on_v) {
        return static_cast<mesh::Index>((on_u << u) + (on_v << v) + (static_cast<std::size_t>(side) << axis));
      };
      std::array<mesh::Index, 4> loop{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
      const auto shifted = [&](const Vec3f& p) {
        const float step = side == 1 ? band : -band;
        return p + Vec3f(axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
      };
      for (int i = 0; i < (axis == 2 ? 6 : 5); ++i) {
        std::array<mesh::Index, 4> next{};
        for (std::size_t k = 0; k < 4; ++k) {
          next[k] = static_cast<mesh::Index>(out.positions.size());
          out.positions.push_back(shifted(out.positions[loop[k]]));
        }
        for (std::size_t k = 0; k < 4; ++k) {
          out.triangles.push_back({loop[k], loop[(k + 1) % 4], next[(k + 1) % 4]});
          out.triangles.push_back({loop[k], next[(k + 1) % 4], next[k]});
        }
        loop = next;
      }
      const auto middle = static_cast<mesh::Index>(out.positions.size());
      out.positions.push_back((out.positions[loop[0]] + out.positions[loop[2]]) * 0.5F);
      for (std::size_t k = 0; k < 4; ++k) out.triangles.push_back({middle, loop[k], loop[(k + 1) % 4]});
    }
  }
  return out;
}

} // namespace orbis::test
