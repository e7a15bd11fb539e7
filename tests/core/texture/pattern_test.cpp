#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "atlas_of.h"
#include "core/texture/bake.h"
#include "core/texture/color.h"
#include "core/texture/cube_map.h"
#include "core/texture/lettering.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

Image pattern(std::uint32_t size) { return patterned(atlas_of(subdivided(octahedron(), 2), size)); }

} // namespace

TEST_CASE("a face is seen from outside: u to the right, v down, and neighbours in counter-clockwise order") {
  for (Face f = 0; f < face_count; ++f) {
    const Vec3d right = axis_vector(face_right[f]), down = axis_vector(face_down[f]);
    CHECK(dot(cross(right, down), axis_vector(f)) == -1);
    for (const double u : {-0.75, 0.0, 0.5})
      for (const double v : {-0.5, 0.25}) {
        const Vec3d d = direction(f, {u, v});
        CHECK(face_of(d) == f);
        CHECK(project(d * 3.0, f).u == doctest::Approx(u));
        CHECK(project(d * 3.0, f).v == doctest::Approx(v));
      }
  }
}

TEST_CASE("every face of the pattern has its own two colours") {
  const CutMesh mesh = atlas_of(subdivided(octahedron(), 3), 1024);
  const Image image = patterned(mesh);
  const std::vector<Vec3d> shown = directions(mesh);
  std::array<std::map<std::array<int, 3>, int>, 6> colours;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown[i] == Vec3d{}) continue;
    const std::uint8_t* p = image.pixels.data() + 3 * i;
    ++colours[face_of(shown[i])][{p[0], p[1], p[2]}];
  }
  std::set<std::array<int, 3>> common;
  for (const auto& of_face : colours)
    for (const auto& [colour, count] : of_face)
      if (count > 4000) common.insert(colour);
  CHECK(common.size() == 12);
}

TEST_CASE("the pattern fills the whole atlas at every size, twice the same") {
  for (const std::uint32_t size : {64U, 100U, 333U, 1024U}) {
    CAPTURE(size);
    const Image image = pattern(size);
    CHECK(image.pixels == pattern(size).pixels);
    std::uint64_t black = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x)
        black += image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2] == 0 ? 1 : 0;
    CHECK(black == 0);
  }
}

TEST_CASE("sRGB bytes survive the way to linear light and back") {
  for (int b = 0; b < 256; ++b) CHECK(to_srgb(to_linear(static_cast<std::uint8_t>(b))) == b);
  CHECK(to_linear(0) == 0);
  CHECK(to_linear(255) == 1);
  CHECK(to_linear(188) == doctest::Approx(0.5).epsilon(0.01));
  CHECK(mixed({0, 0, 0}, {255, 255, 255}, 0.5F)[0] == 188);
}

TEST_CASE("letters that the pattern uses can be told apart") {
  std::set<std::string> shapes;
  const std::string letters = "+-ABCDEFGHXYZ12345678";
  for (const char letter : letters) {
    const auto coverage = draw_text(std::string(1, letter), 12).coverage;
    shapes.emplace(coverage.begin(), coverage.end());
  }
  CHECK(shapes.size() == letters.size());
}
