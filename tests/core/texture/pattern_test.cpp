#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <string>

#include "core/texture/bake.h"
#include "core/texture/color.h"
#include "core/texture/lettering.h"

using namespace orbis;
using namespace orbis::texture;

namespace {

Image pattern(std::uint32_t size) {
  NoProgress progress;
  return bake_pattern(layout_for(size), progress);
}

} // namespace

TEST_CASE("an atlas has six charts that do not overlap, gutters between them, and a height that is a multiple of 4") {
  for (const std::uint32_t size : {64U, 65U, 100U, 1024U, 2047U, 2048U, 8192U}) {
    CAPTURE(size);
    const AtlasLayout layout = layout_for(size);
    CHECK(layout.width == size);
    CHECK(layout.height % 4 == 0);
    CHECK(layout.height >= 2 * layout.cell);
    CHECK(3 * layout.cell <= layout.width);
    CHECK(layout.gutter >= 2);
    CHECK((layout.gutter & (layout.gutter - 1)) == 0);
    std::uint64_t covered = 0;
    for (std::uint32_t y = 0; y < layout.height; ++y)
      for (std::uint32_t x = 0; x < layout.width; ++x) covered += layout.in_chart(x, y) ? 1 : 0;
    CHECK(covered == std::uint64_t{6} * layout.chart() * layout.chart());
    const double all = static_cast<double>(layout.width) * layout.height;
    CHECK(layout.utilisation() == doctest::Approx(static_cast<double>(covered) / all));
  }
}

TEST_CASE("an atlas outside 64 to 8192 texels is refused by the option's name") {
  for (const std::uint32_t size : {0U, 63U, 8193U}) try {
      (void)layout_for(size);
      FAIL("accepted");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalid_option);
      CHECK(e.where() == "texture_size");
    }
}

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

TEST_CASE("every face of the pattern has its own colour, and every field its own label") {
  const Image image = pattern(1024);
  const AtlasLayout layout = layout_for(1024);
  std::set<std::string> fields;
  std::set<std::array<int, 3>> colours;
  const std::uint32_t field = layout.chart() / 8;
  for (Face f = 0; f < face_count; ++f)
    for (std::uint32_t row = 0; row < 8; ++row)
      for (std::uint32_t column = 0; column < 8; ++column) {
        std::string texels; // bytes
        for (std::uint32_t y = 3; y + 3 < field; ++y) {
          const auto* first = image.at(layout.chart_x(f) + column * layout.chart() / 8 + 3,
                                       layout.chart_y(f) + row * layout.chart() / 8 + y);
          texels.append(reinterpret_cast<const char*>(first), std::size_t{3} * (field - 6));
        }
        fields.insert(texels);
        colours.insert({texels[0], texels[1], texels[2]});
      }
  CHECK(fields.size() == 6 * 8 * 8);
  CHECK(colours.size() == 12);
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

TEST_CASE("gutters go on with the neighbouring face: a smooth image on the sphere has no seam") {
  const AtlasLayout layout = layout_for(512);
  Image image{layout.width, layout.height, 4, {}};
  image.pixels.assign(std::size_t{layout.width} * layout.height * 4, 0);
  const auto color_at = [](const Vec3d& d) {
    const Vec3d n = normalized(d);
    const auto byte = [](double v) { return to_srgb(static_cast<float>(0.5 + 0.4 * v)); };
    return std::array<std::uint8_t, 4>{byte(n.x), byte(n.y), byte(n.z), to_byte(static_cast<float>(0.5 + 0.4 * n.y))};
  };
  const auto direction_at = [&](std::uint32_t x, std::uint32_t y) {
    const Face f = layout.face_at(x, y);
    return direction(f, layout.face_point(f, x + 0.5, y + 0.5));
  };
  for (std::uint32_t y = 0; y < layout.height; ++y)
    for (std::uint32_t x = 0; x < layout.width; ++x)
      if (layout.in_chart(x, y)) std::ranges::copy(color_at(direction_at(x, y)), image.at(x, y));
  fill_gutters(layout, image);
  int worst = 0;
  for (std::uint32_t y = 0; y < layout.height; ++y)
    for (std::uint32_t x = 0; x < layout.width; ++x) {
      const auto expected = color_at(direction_at(x, y));
      for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(image.at(x, y)[c] - expected[c]));
    }
  CHECK(worst <= 3);
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
