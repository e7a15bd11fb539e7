// Tangents by the conventions that engines share.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/texture/tangents.h"

using namespace orbis;
using namespace orbis::texture;
using mesh::Triangle;

namespace {

struct Quad {
  std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<Vec3f> normals = std::vector<Vec3f>(4, Vec3f{0, 0, 1});
  std::vector<Vec2f> uv{{0, 1}, {1, 1}, {1, 0}, {0, 0}}; // upright: v runs down
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};

  [[nodiscard]] std::vector<std::array<Tangent, 3>> tangents() const {
    return corner_tangents(positions, normals, uv, triangles);
  }
};

void check_all(const Quad& quad, const Tangent& expected) {
  for (const auto& corners : quad.tangents())
    for (const Tangent& t : corners) {
      CHECK(t.x == doctest::Approx(expected.x));
      CHECK(t.y == doctest::Approx(expected.y));
      CHECK(t.z == doctest::Approx(expected.z));
      CHECK(t.w == expected.w);
    }
}

} // namespace

TEST_CASE("the tangent runs along growing u, and w tells a mirrored texture") {
  Quad quad;
  check_all(quad, {1, 0, 0, 1});
  quad.uv = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
  check_all(quad, {-1, 0, 0, -1});
  quad.uv = {{0, 0}, {0, 1}, {1, 1}, {1, 0}}; // a quarter turn
  check_all(quad, {0, 1, 0, 1});
}

TEST_CASE("tangents are perpendicular to the normals, and the mean over the fan by its angles") {
  // A roof: the texture runs over its ridge, which both sides share.
  Quad quad;
  quad.positions = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}};
  quad.normals.assign(6, Vec3f(normalized(Vec3d{0.2, 0, 1})));
  quad.uv = {{0, 1}, {0, 0}, {0.5F, 1}, {0.5F, 0}, {1, 1}, {1, 0}};
  quad.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  const auto corners = quad.tangents();
  for (const auto& triangle : corners)
    for (const Tangent& t : triangle) {
      CHECK(dot(Vec3d{t.x, t.y, t.z}, Vec3d(quad.normals[0])) == doctest::Approx(0).epsilon(1e-6).scale(1));
      CHECK(norm(Vec3d{t.x, t.y, t.z}) == doctest::Approx(1));
    }
  CHECK(corners[0][1] == corners[2][0]); // vertex 2, seen from both sides
}

TEST_CASE("the halves of a mirrored texture that meet at an edge keep their own tangents there") {
  Quad quad;
  quad.positions = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}};
  quad.normals.assign(6, Vec3f{0, 0, 1});
  quad.uv = {{0, 1}, {0, 0}, {1, 1}, {1, 0}, {0, 1}, {0, 0}};
  quad.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  const auto corners = quad.tangents();
  CHECK(corners[0][1] == Tangent{1, 0, 0, 1});
  CHECK(corners[2][0] == Tangent{-1, 0, 0, -1});
}

TEST_CASE("triangles that say nothing take their neighbours' tangent, or any that is perpendicular") {
  Quad quad;
  quad.uv[3] = quad.uv[2]; // the second triangle has no area in the texture
  quad.positions[3] = {1, 2, 0};
  const auto corners = quad.tangents();
  CHECK(corners[1][0] == corners[0][0]);
  CHECK(corners[1][1] == corners[0][2]);

  Quad flat;
  flat.uv.assign(4, Vec2f{0.5F, 0.5F});
  for (const auto& triangle : flat.tangents())
    for (const Tangent& t : triangle) {
      CHECK(t.z == 0);
      CHECK(std::hypot(t.x, t.y) == doctest::Approx(1));
    }
}
