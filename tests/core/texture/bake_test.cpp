#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "atlas_of.h"
#include "core/texture/bake.h"
#include "core/texture/color.h"
#include "core/texture/cube_map.h"
#include "core/texture/sampler.h"
#include "sphere_meshes.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

// A smooth colour for each direction.
Light color_at(const Vec3d& direction) {
  const Vec3d n = normalized(direction);
  const auto value = [](double v) { return static_cast<float>(0.5 + 0.4 * v); };
  return {value(n.x), value(n.y), value(n.z), value(n.x * n.y)};
}

Image blank(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image{width, height, channels, {}};
  image.pixels.resize(std::size_t{width} * height * channels);
  return image;
}

Image face_image(Face f, std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image = blank(width, height, channels);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      store(color_at(direction(f, {2 * (x + 0.5) / width - 1, 2 * (y + 0.5) / height - 1})), image, x, y);
  return image;
}

// The largest difference of any covered texel from the colour of its direction.
int worst_difference(const CutMesh& mesh, const Image& image) {
  const std::vector<Vec3d> shown = directions(mesh);
  Image expected = blank(1, 1, image.channels);
  int worst = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const Vec3d& d = shown[std::size_t{y} * image.width + x];
      if (d == Vec3d{}) continue;
      store(color_at(d), expected, 0, 0);
      for (std::size_t c = 0; c < image.channels; ++c)
        worst = std::max(worst, std::abs(image.at(x, y)[c] - expected.at(0, 0)[c]));
    }
  return worst;
}

} // namespace

TEST_CASE("six images of any sizes are reproduced by direction, without a seam at the borders") {
  for (const std::uint32_t size : {64U, 200U, 700U}) {
    CAPTURE(size);
    std::vector<Image> images;
    for (Face f = 0; f < face_count; ++f) images.push_back(face_image(f, size + 5 * f, size + 3, 3));
    const CutMesh mesh = atlas_of(subdivided(icosahedron(), 2), 384);
    const Image atlas = surrounded(mesh, images);
    CHECK(atlas.channels == 3);
    CHECK(worst_difference(mesh, atlas) <= 4);
  }
}

TEST_CASE("one equirectangular image is reproduced by direction: +Z in its middle, +X to the right, +Y on top") {
  for (const std::uint32_t width : {256U, 1500U}) {
    CAPTURE(width);
    Image globe = blank(width, width / 2, 4);
    for (std::uint32_t y = 0; y < globe.height; ++y)
      for (std::uint32_t x = 0; x < globe.width; ++x) {
        const double longitude = 2 * std::numbers::pi * ((x + 0.5) / globe.width - 0.5);
        const double latitude = std::numbers::pi * (0.5 - (y + 0.5) / globe.height);
        store(color_at({std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                        std::cos(longitude) * std::cos(latitude)}),
              globe, x, y);
      }
    const CutMesh mesh = atlas_of(subdivided(icosahedron(), 2), 384);
    const Image atlas = surrounded(mesh, std::span(&globe, 1));
    CHECK(atlas.channels == 4);
    CHECK(worst_difference(mesh, atlas) <= 4);
  }
}

TEST_CASE("any other number of images, or one without pixels, is refused") {
  std::vector<Image> images(2, face_image(0, 8, 8, 3));
  CHECK_THROWS_AS((void)surrounded(atlas_of(octahedron(), 64), images), Error);
  images.assign(1, Image{});
  CHECK_THROWS_AS((void)surrounded(atlas_of(octahedron(), 64), images), Error);
}

TEST_CASE("wrap modes move the reads as a renderer would") {
  Image image = blank(4, 4, 3);
  std::mt19937 random(8);
  for (auto& byte : image.pixels) byte = static_cast<std::uint8_t>(random());
  const auto read = [&](Wrap wrap, double x, double y) { return Sampler(image, wrap, wrap, 1).sample(x, y, 0); };
  for (const double x : {0.5, 1.75, 3.5, 3.9}) {
    CHECK(read(Wrap::repeat, x + 4, 1.5)[0] == doctest::Approx(read(Wrap::repeat, x, 1.5)[0]));
    CHECK(read(Wrap::repeat, x - 12, 1.5)[0] == doctest::Approx(read(Wrap::repeat, x, 1.5)[0]));
    CHECK(read(Wrap::mirror, -x, 1.5)[1] == doctest::Approx(read(Wrap::mirror, x, 1.5)[1]));
    CHECK(read(Wrap::mirror, 8 + x, 8 - 1.5)[1] == doctest::Approx(read(Wrap::mirror, x, 1.5)[1]));
    CHECK(read(Wrap::clamp, 4 + x, 2.5) == load(image, 3, 2));
    CHECK(read(Wrap::clamp, -x, 2.5) == load(image, 0, 2));
  }
  // Between the last texel and the first.
  CHECK(read(Wrap::repeat, 4, 0.5)[2] == doctest::Approx((load(image, 3, 0)[2] + load(image, 0, 0)[2]) / 2));
  CHECK(read(Wrap::repeat, NAN, INFINITY) == read(Wrap::repeat, 0, 0));
}

TEST_CASE("pictures are the same on any number of threads, and stop when they are asked to") {
  const SphereMesh mesh = subdivided(icosahedron(), 1);
  const CutMesh cut_mesh = atlas_of(mesh, 256);
  const Image image = face_image(2, 50, 100, 3);
  const NoProgress progress;
  CHECK(patterned(cut_mesh).pixels == patterned(cut_mesh, progress, 3).pixels);
  CHECK(surrounded(cut_mesh, std::span(&image, 1)).pixels ==
        surrounded(cut_mesh, std::span(&image, 1), progress, 3).pixels);

  struct Canceled final : Progress {
    void report(Stage, std::uint64_t, std::uint64_t) override {}
    [[nodiscard]] bool cancelled() const override { return true; }
  } canceled;
  CHECK_THROWS_AS((void)patterned(cut_mesh, canceled), Error);
  CHECK_THROWS_AS((void)surrounded(cut_mesh, std::span(&image, 1), canceled), Error);
  const std::vector<GridPoint> grid = mesh.grid();
  const std::vector<Vec3f> positions(grid.size());
  CHECK_THROWS_AS((void)make_atlas({mesh.triangles, mesh.triangles, grid, positions, 1}, 64, canceled), Error);
}
