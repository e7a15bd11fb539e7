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

struct Scene {
  SphereMesh mesh;
  CutMesh cut_mesh;
  std::vector<std::uint32_t> source_of;

  Scene(SphereMesh sphere, std::uint32_t texture_size)
      : mesh(std::move(sphere)), cut_mesh(atlas_of(mesh, texture_size)), source_of(mesh.triangles.size(), 0) {}

  // Texture coordinates that are linear on each input triangle, as glTF's are.
  template <class F> [[nodiscard]] std::vector<Vec2f> uv(F at_corner) const {
    std::vector<Vec2f> result;
    for (const CutVertex& v : cut_mesh.vertices) {
      double x = 0, y = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [u, w] = at_corner(v.triangle, k);
        x += v.barycentric[k] * u;
        y += v.barycentric[k] * w;
      }
      result.push_back({static_cast<float>(x), static_cast<float>(y)});
    }
    return result;
  }
  [[nodiscard]] Image bake(const std::vector<Vec2f>& coordinates, std::span<const BaseColorSource> sources) const {
    NoProgress progress;
    return bake_base_color(cut_mesh, 0, coordinates, source_of, sources, progress);
  }
};

// Every input triangle shows the same right-angled half of the image.
std::array<double, 2> half_image(std::uint32_t, std::size_t corner) {
  return {corner == 1 ? 1.0 : 0.0, corner == 2 ? 1.0 : 0.0};
}

} // namespace

TEST_CASE("six images of any sizes are reproduced by direction, without a seam at the borders") {
  NoProgress progress;
  for (const std::uint32_t size : {64U, 200U, 700U}) {
    CAPTURE(size);
    std::vector<Image> images;
    for (Face f = 0; f < face_count; ++f) images.push_back(face_image(f, size + 5 * f, size + 3, 3));
    const CutMesh mesh = atlas_of(subdivided(icosahedron(), 2), 384);
    const Image atlas = bake_cube_map(mesh, 0, images, progress);
    CHECK(atlas.channels == 3);
    CHECK(worst_difference(mesh, atlas) <= 4);
  }
}

TEST_CASE("one equirectangular image is reproduced by direction: +Z in its middle, +X to the right, +Y on top") {
  NoProgress progress;
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
    const Image atlas = bake_cube_map(mesh, 0, std::span(&globe, 1), progress);
    CHECK(atlas.channels == 4);
    CHECK(worst_difference(mesh, atlas) <= 4);
  }
}

TEST_CASE("any other number of images, or one without pixels, is refused") {
  NoProgress progress;
  std::vector<Image> images(2, face_image(0, 8, 8, 3));
  CHECK_THROWS_AS((void)bake_cube_map(atlas_of(octahedron(), 64), 0, images, progress), Error);
  images.assign(1, Image{});
  CHECK_THROWS_AS((void)bake_cube_map(atlas_of(octahedron(), 64), 0, images, progress), Error);
}

TEST_CASE("the base colour is what the input showed at that point of the surface") {
  std::mt19937 random(6);
  const Scene scene(turned(subdivided(icosahedron(), 2), random), 512);
  // A linear ramp in linear light, so that bilinear reads and means are exact but for rounding.
  Image image = blank(64, 64, 4);
  const auto ramp = [](double u, double v) {
    return Light{static_cast<float>(0.1 + 0.8 * u), static_cast<float>(0.1 + 0.8 * v),
                 static_cast<float>(0.9 - 0.4 * u - 0.4 * v), static_cast<float>(0.2 + 0.6 * u)};
  };
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) store(ramp((x + 0.5) / 64, (y + 0.5) / 64), image, x, y);
  BaseColorSource source;
  source.image = &image;
  source.wrap_u = source.wrap_v = Wrap::clamp;
  const auto shrunk = [](std::uint32_t, std::size_t k) { return std::array{k == 1 ? 0.9 : 0.1, k == 2 ? 0.9 : 0.1}; };
  const std::vector<Vec2f> uv = scene.uv(shrunk);
  const Image atlas = scene.bake(uv, std::span(&source, 1));
  REQUIRE(atlas.channels == 4);

  // At random places of random delivered triangles, away from their edges by more than a texel.
  int compared = 0, worst = 0;
  for (const Triangle& t : scene.cut_mesh.triangles)
    for (int round = 0; round < 3; ++round) {
      std::array<double, 3> w{};
      for (double& weight : w) weight = 0.2 + 0.001 * static_cast<double>(random() % 400);
      const double sum = w[0] + w[1] + w[2];
      double x = 0, y = 0, u = 0, v = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const CutVertex& corner = scene.cut_mesh.vertices[t[k]];
        x += w[k] / sum * corner.uv.x * atlas.width;
        y += w[k] / sum * corner.uv.y * atlas.height;
        u += w[k] / sum * uv[t[k]].x;
        v += w[k] / sum * uv[t[k]].y;
      }
      const Sampler shown(atlas, Wrap::clamp, Wrap::clamp, 1);
      // Triangles of some size: in small ones bilinear reads reach over their edges.
      const Vec2f &p = scene.cut_mesh.vertices[t[0]].uv, &q = scene.cut_mesh.vertices[t[1]].uv,
                  &r = scene.cut_mesh.vertices[t[2]].uv;
      const double area = double{std::abs((q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y))} * 512 * atlas.height;
      if (area < 300) continue;
      const Light seen = shown.sample(x, y, 0), expected = ramp(u, v);
      for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(to_srgb(seen[c]) - to_srgb(expected[c])));
      worst = std::max(worst, std::abs(to_byte(seen[3]) - to_byte(expected[3])));
      ++compared;
    }
  CHECK(compared > 100);
  CHECK(worst <= 3);
}

TEST_CASE("wrap modes and KHR_texture_transform move the reads as a renderer would") {
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

  const Scene scene(octahedron(), 128);
  BaseColorSource moved, plain;
  moved.image = plain.image = &image;
  moved.transform = {0.5F, -0.25F, 0.3F, 0.125F, 2, -0.7F};
  const std::vector<Vec2f> uv = scene.uv(half_image);
  std::vector<Vec2f> by_hand;
  for (const Vec2f& p : uv) by_hand.push_back({0.5F * p.x - 0.25F * p.y + 0.3F, 0.125F * p.x + 2 * p.y - 0.7F});
  const Image a = scene.bake(uv, std::span(&moved, 1)), b = scene.bake(by_hand, std::span(&plain, 1));
  for (std::size_t i = 0; i < a.pixels.size(); ++i) CHECK(std::abs(a.pixels[i] - b.pixels[i]) <= 1);
}

TEST_CASE("a finer image is averaged in linear light, not picked from") {
  const Scene scene(subdivided(octahedron(), 1), 128);
  Image image = blank(2048, 2048, 3); // black and white texels by turns
  for (std::uint32_t y = 0; y < 2048; ++y)
    for (std::uint32_t x = 0; x < 2048; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] = (x + y) % 2 == 0 ? 255 : 0;
  BaseColorSource source;
  source.image = &image;
  const Image atlas = scene.bake(scene.uv(half_image), std::span(&source, 1));
  const auto [low, high] = std::minmax_element(atlas.pixels.begin(), atlas.pixels.end());
  CHECK(*low >= 180); // half the light is sRGB 188; a mean of bytes would be 128
  CHECK(*high <= 196);
}

TEST_CASE("each input triangle takes its own source, and a flat colour where there is no image") {
  Scene scene(octahedron(), 128);
  for (std::uint32_t t = 0; t < scene.source_of.size(); ++t) scene.source_of[t] = t % 2;
  std::array<BaseColorSource, 2> sources;
  sources[0].color = {1, 0, 0, 1};
  sources[1].color = {0, 0, 1, 0.5F};
  const Image atlas = scene.bake(scene.uv(half_image), sources);
  REQUIRE(atlas.channels == 4);
  std::array<std::size_t, 2> found{};
  const std::vector<Vec3d> shown = directions(scene.cut_mesh);
  for (std::uint32_t y = 0; y < atlas.height; ++y)
    for (std::uint32_t x = 0; x < atlas.width; ++x) {
      if (shown[std::size_t{y} * atlas.width + x] == Vec3d{}) continue;
      const std::uint8_t* p = atlas.at(x, y);
      const bool red = p[0] == 255 && p[2] == 0 && p[3] == 255, blue = p[0] == 0 && p[2] == 255 && p[3] == 128;
      CHECK(red != blue);
      ++found[red ? 0 : 1];
    }
  // The octants of the sphere alternate, so each colour has half of it.
  CHECK(found[0] == found[1]);
}

TEST_CASE("baking twice gives the same bytes, and stops when it is asked to") {
  const Scene scene(subdivided(icosahedron(), 1), 256);
  const Image image = face_image(2, 50, 60, 3);
  BaseColorSource source;
  source.image = &image;
  const std::vector<Vec2f> uv = scene.uv(half_image);
  CHECK(scene.bake(uv, std::span(&source, 1)).pixels == scene.bake(uv, std::span(&source, 1)).pixels);

  struct Canceled final : Progress {
    void report(Stage, std::uint64_t, std::uint64_t) override {}
    [[nodiscard]] bool cancelled() const override { return true; }
  } canceled;
  CHECK_THROWS_AS((void)bake_pattern(scene.cut_mesh, 0, canceled), Error);
  CHECK_THROWS_AS((void)bake_cube_map(scene.cut_mesh, 0, std::span(&image, 1), canceled), Error);
  CHECK_THROWS_AS((void)bake_base_color(scene.cut_mesh, 0, uv, scene.source_of, std::span(&source, 1), canceled),
                  Error);
  const std::vector<GridPoint> grid = scene.mesh.grid();
  const std::vector<Vec3f> positions(grid.size());
  CHECK_THROWS_AS((void)make_atlas({scene.mesh.triangles, scene.mesh.triangles, grid, positions, 1}, 64, canceled),
                  Error);
}
