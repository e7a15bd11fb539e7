// Maps baked from textures and geometry: what a texel shows is what the surface has there.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>

#include "core/texture/bake_maps.h"
#include "core/texture/bake_occlusion.h"

using namespace orbis;
using namespace orbis::texture;
using mesh::ThreadPool;
using mesh::Triangle;

namespace {

constexpr std::uint32_t size = 128;

// An n x n field of squares in the middle of a page, each of two triangles, its inner vertices shaken.
struct Sheet {
  std::uint32_t n;
  std::vector<Vec2f> uv;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> all;

  explicit Sheet(std::uint32_t squares) : n(squares) {
    std::mt19937 random(3);
    const auto shaken = [&](std::uint32_t i) {
      const float shake = i == 0 || i == n ? 0 : 0.5F * (static_cast<float>(random() % 1000) / 1000 - 0.5F);
      return 0.15F + 0.7F * (static_cast<float>(i) + shake) / static_cast<float>(n);
    };
    for (std::uint32_t j = 0; j <= n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i) {
        const float x = shaken(i), y = shaken(j);
        uv.push_back({x, y});
      }
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
        triangles.push_back({a, c, b}); // counter-clockwise seen from outside: v points down
        triangles.push_back({b, c, d});
      }
    all.resize(triangles.size());
    std::iota(all.begin(), all.end(), 0U);
  }

  [[nodiscard]] PageMesh page() const { return {uv, triangles, all}; }

  template <class Value, class F> [[nodiscard]] std::vector<std::array<Value, 3>> corners(F at_vertex) const {
    std::vector<std::array<Value, 3>> out;
    for (const Triangle& t : triangles) out.push_back({at_vertex(t[0]), at_vertex(t[1]), at_vertex(t[2])});
    return out;
  }
  // A cap of a sphere over the page.
  [[nodiscard]] Vec3f normal(std::uint32_t v) const {
    return Vec3f(normalized(Vec3d{1.4 * (uv[v].x - 0.5), -1.4 * (uv[v].y - 0.5), 0.8}));
  }
};

Image blank(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image{width, height, channels, {}};
  image.pixels.resize(std::size_t{width} * height * channels);
  return image;
}

Image noise(std::uint32_t side, std::uint32_t channels, unsigned seed) {
  Image image = blank(side, side, channels);
  std::mt19937 random(seed);
  for (auto& byte : image.pixels) byte = static_cast<std::uint8_t>(random());
  return image;
}

Image bake(const Sheet& sheet, std::span<const CornerUv> uv, std::span<const std::uint32_t> source_of,
           std::span<const TextureSource> sources, Encoding encoding, bool alpha, std::uint32_t threads = 1,
           std::span<const CornerColor> colors = {}) {
  ThreadPool pool(threads);
  const TexelMap map(sheet.page(), size, size, pool);
  const TextureReader reader(map, sheet.all, uv, source_of, sources, encoding);
  return bake_texture(map, reader, colors, encoding, alpha, NoProgress(), pool);
}

Vec3d decoded(const Image16& image, std::uint32_t x, std::uint32_t y) {
  const std::uint16_t* p = image.at(x, y);
  return {p[0] / 32767.5 - 1, p[1] / 32767.5 - 1, p[2] / 32767.5 - 1};
}

std::array<double, 3> weights_at(const TexelMap& map, std::uint32_t x, std::uint32_t y) {
  const TriangleInPage place = map.place(map.triangle(x, y));
  return place.nearest_weights(x + 0.5, y + 0.5);
}

} // namespace

TEST_CASE("every texel shows a point of the surface: its own, or the nearest one beside it") {
  const Sheet sheet(9);
  ThreadPool pool(1);
  const TexelMap map(sheet.page(), size, size, pool);
  std::uint64_t covered = 0;
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      REQUIRE(map.triangle(x, y) < sheet.triangles.size());
      const auto inside = [](double c) { return c > 0.15 * size && c < 0.85 * size; };
      CHECK(map.covered(x, y) == (inside(x + 0.5) && inside(y + 0.5)));
      covered += map.covered(x, y) ? 1 : 0;
      const auto w = weights_at(map, x, y);
      CHECK(*std::min_element(w.begin(), w.end()) > -1e-6);
      CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
      // The point shown lies where the texel does, or for a gutter close by.
      double u = 0, v = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        u += w[k] * sheet.uv[sheet.triangles[map.triangle(x, y)][k]].x * size;
        v += w[k] * sheet.uv[sheet.triangles[map.triangle(x, y)][k]].y * size;
      }
      const double beyond_x = std::max({0.15 * size - (x + 0.5), (x + 0.5) - 0.85 * size, 0.0});
      const double beyond_y = std::max({0.15 * size - (y + 0.5), (y + 0.5) - 0.85 * size, 0.0});
      CHECK(std::hypot(u - (x + 0.5), v - (y + 0.5)) <= beyond_x + beyond_y + 1.5);
    }
  CHECK(covered == map.covered_texels());
}

TEST_CASE("a map is the same on any number of threads") {
  const Sheet sheet(13);
  const Image image = noise(64, 3, 5);
  TextureSource source;
  source.image = &image;
  const std::vector<std::uint32_t> source_of(sheet.triangles.size(), 0);
  const auto uv = sheet.corners<Vec2f>([&](std::uint32_t v) { return Vec2f{3 * sheet.uv[v].y, 2 * sheet.uv[v].x}; });
  const auto on = [&](std::uint32_t threads) {
    return bake(sheet, uv, source_of, std::span(&source, 1), Encoding::srgb, false, threads).pixels;
  };
  CHECK(on(1) == on(2));
  CHECK(on(1) == on(5));
}

TEST_CASE("a texture is shown where its coordinates put it, whatever way they run") {
  const Sheet sheet(5);
  Image image = blank(64, 64, 4);
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x)
      store({(static_cast<float>(x) + 0.5F) / 64, (static_cast<float>(y) + 0.5F) / 64, 0.5F,
             1 - (static_cast<float>(x) + 0.5F) / 64},
            image, x, y, Encoding::linear);
  TextureSource source;
  source.image = &image;
  source.wrap_u = source.wrap_v = Wrap::clamp;
  source.transform = {0, 0.5F, 0.25F, -0.5F, 0, 0.75F}; // a quarter turn, half as large, moved
  const std::vector<std::uint32_t> source_of(sheet.triangles.size(), 0);
  const auto uv = sheet.corners<Vec2f>([&](std::uint32_t v) { return sheet.uv[v]; });
  const Image page = bake(sheet, uv, source_of, std::span(&source, 1), Encoding::linear, true);
  REQUIRE(page.channels == 4);
  int worst = 0;
  for (std::uint32_t y = 20; y < 108; ++y)
    for (std::uint32_t x = 20; x < 108; ++x) {
      const double u = 0.5 * (y + 0.5) / size + 0.25, v = -0.5 * (x + 0.5) / size + 0.75;
      worst = std::max(worst, static_cast<int>(std::abs(page.at(x, y)[0] - std::lround(255 * u))));
      worst = std::max(worst, static_cast<int>(std::abs(page.at(x, y)[1] - std::lround(255 * v))));
      worst = std::max(worst, static_cast<int>(std::abs(page.at(x, y)[3] - std::lround(255 * (1 - u)))));
    }
  CHECK(worst <= 1);
}

TEST_CASE("a finer image is averaged, colours as light and data as numbers") {
  const Sheet sheet(3);
  Image image = blank(1024, 1024, 3); // black and white texels by turns
  for (std::uint32_t y = 0; y < 1024; ++y)
    for (std::uint32_t x = 0; x < 1024; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] = (x + y) % 2 == 0 ? 255 : 0;
  TextureSource source;
  source.image = &image;
  const std::vector<std::uint32_t> source_of(sheet.triangles.size(), 0);
  const auto uv = sheet.corners<Vec2f>([&](std::uint32_t v) { return sheet.uv[v]; });
  const auto range = [&](Encoding encoding) {
    const Image page = bake(sheet, uv, source_of, std::span(&source, 1), encoding, false);
    const auto [low, high] = std::minmax_element(page.pixels.begin(), page.pixels.end());
    return std::array<int, 2>{*low, *high};
  };
  const auto [dark, bright] = range(Encoding::srgb);
  CHECK(dark >= 180); // half the light is sRGB 188
  CHECK(bright <= 196);
  const auto [low, high] = range(Encoding::linear);
  CHECK(low >= 120); // half the number is 128
  CHECK(high <= 136);
}

TEST_CASE("an image that is to be magnified without interpolation keeps its hard texels") {
  const Sheet sheet(2);
  const Image image = noise(4, 3, 9);
  TextureSource source;
  source.image = &image;
  source.nearest = true;
  const std::vector<std::uint32_t> source_of(sheet.triangles.size(), 0);
  const auto uv = sheet.corners<Vec2f>([&](std::uint32_t v) { return sheet.uv[v]; });
  const Image page = bake(sheet, uv, source_of, std::span(&source, 1), Encoding::srgb, false);
  for (std::uint32_t y = 20; y < 108; ++y)
    for (std::uint32_t x = 20; x < 108; ++x)
      CHECK(std::equal(page.at(x, y), page.at(x, y) + 3, image.at(x * 4 / size, y * 4 / size)));
}

TEST_CASE("each triangle takes its own source, a flat colour where there is no image, times the vertex colours") {
  const Sheet sheet(4);
  std::vector<std::uint32_t> source_of;
  for (std::uint32_t t = 0; t < sheet.triangles.size(); ++t) source_of.push_back(t % 2);
  std::array<TextureSource, 2> sources;
  sources[0].color = {1, 0, 0, 1};
  sources[1].color = {0, 0, 1, 0.5F};
  const std::vector<CornerUv> uv(sheet.triangles.size());
  CornerColor half;
  half.fill({0.5F, 0.5F, 0.5F, 1});
  const std::vector<CornerColor> colors(sheet.triangles.size(), half);
  ThreadPool pool(1);
  const TexelMap map(sheet.page(), size, size, pool);
  const Image page = bake(sheet, uv, source_of, sources, Encoding::srgb, true, 1, colors);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const bool red = map.triangle(x, y) % 2 == 0;
      const std::uint8_t half_light = to_srgb(0.5F);
      CHECK(page.at(x, y)[0] == (red ? half_light : 0));
      CHECK(page.at(x, y)[2] == (red ? 0 : half_light));
      CHECK(page.at(x, y)[3] == (red ? 255 : 128));
    }
}

TEST_CASE("a position map gives each texel's point to 16 bits") {
  const Sheet sheet(6);
  ThreadPool pool(1);
  const TexelMap map(sheet.page(), size, size, pool);
  const auto points = sheet.corners<Vec3f>([&](std::uint32_t v) { return sheet.normal(v) * 7.0F; });
  const Box box{{-7, -7, -7}, {7, 7, 7}};
  const Image16 image = bake_positions(map, points, box, NoProgress(), pool);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const auto w = weights_at(map, x, y);
      const auto& p = points[map.triangle(x, y)];
      const Vec3d expected = Vec3d(p[0]) * w[0] + Vec3d(p[1]) * w[1] + Vec3d(p[2]) * w[2];
      CHECK(norm(decoded(image, x, y) * 7.0 - expected) < 14.0 / 65535);
    }
}

TEST_CASE("a normal map gives back the full surface's normals, on its own frames and on those of a coarser mesh") {
  const Sheet fine(24), coarse(2);
  ThreadPool pool(1);
  const TexelMap map(fine.page(), size, size, pool), coarse_map(coarse.page(), size, size, pool);
  // The fine surface is rough: its normals are bent away from the cap's.
  std::mt19937 random(11);
  std::vector<Vec3f> rough;
  for (std::uint32_t v = 0; v < fine.uv.size(); ++v) {
    const auto shake = [&] { return 0.4 * (static_cast<double>(random() % 1000) / 1000 - 0.5); };
    rough.emplace_back(normalized(Vec3d(fine.normal(v)) + Vec3d{shake(), shake(), shake()}));
  }
  const auto normals = fine.corners<Vec3f>([&](std::uint32_t v) { return rough[v]; });
  const std::vector<std::uint32_t> source_of(fine.triangles.size(), 0);
  const NormalSource source{normals, {}, nullptr, {}, source_of};
  const auto in_space = bake_normals<Image16>(map, source, nullptr, NoProgress(), pool);

  for (const bool own : {true, false}) {
    CAPTURE(own);
    const Sheet& sheet = own ? fine : coarse;
    std::vector<Vec3f> frame_normals;
    std::vector<Tangent> frame_tangents;
    for (std::uint32_t v = 0; v < sheet.uv.size(); ++v) {
      const Vec3d n(own ? rough[v] : sheet.normal(v)), t = normalized(cross(Vec3d{0, 1, 0}, n));
      frame_normals.emplace_back(n);
      frame_tangents.push_back(
          {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z), own ? -1.0F : 1.0F});
    }
    const TexelMap& frames_map = own ? map : coarse_map;
    const FrameField frames{&frames_map, sheet.triangles, frame_normals, frame_tangents};
    const auto tangent_space = bake_normals<Image16>(map, source, &frames, NoProgress(), pool);
    double worst = 0;
    for (std::uint32_t y = 20; y < 108; ++y)
      for (std::uint32_t x = 20; x < 108; ++x) {
        // As a renderer rebuilds it.
        const auto w = weights_at(frames_map, x, y);
        Vec3d n, t, b;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = sheet.triangles[frames_map.triangle(x, y)][k];
          const Vec3d normal(frame_normals[v]), tangent{frame_tangents[v].x, frame_tangents[v].y, frame_tangents[v].z};
          n += normal * w[k];
          t += tangent * w[k];
          b += cross(normal, tangent) * (double{frame_tangents[v].w} * w[k]);
        }
        const Vec3d c = decoded(tangent_space, x, y);
        const Vec3d seen = normalized(normalized(t) * c.x + normalized(b) * c.y + normalized(n) * c.z);
        worst = std::max(worst, norm(seen - normalized(decoded(in_space, x, y))));
      }
    CHECK(worst < 2e-3);
  }
}

TEST_CASE("the input's own normal map is turned with its tangents, and scaled") {
  const Sheet sheet(4);
  ThreadPool pool(1);
  const TexelMap map(sheet.page(), size, size, pool);
  Image leaning = blank(1, 1, 3); // 30 degrees towards +u
  store({0.75F, 0.5F, 0.933F, 1}, leaning, 0, 0, Encoding::linear);
  TextureSource texture;
  texture.image = &leaning;
  const std::vector<std::uint32_t> source_of(sheet.triangles.size(), 0);
  const std::vector<CornerUv> uv(sheet.triangles.size());
  const TextureReader reader(map, sheet.all, uv, source_of, std::span(&texture, 1), Encoding::linear);
  const auto normals = sheet.corners<Vec3f>([](std::uint32_t) { return Vec3f{0, 0, 1}; });
  const auto tangents = sheet.corners<Tangent>([](std::uint32_t) { return Tangent{0, 1, 0, 1}; });
  for (const float scale : {1.0F, 0.5F, 0.0F}) {
    CAPTURE(scale);
    const NormalSource source{normals, tangents, &reader, std::span(&scale, 1), source_of};
    const Vec3d n = decoded(bake_normals<Image16>(map, source, nullptr, NoProgress(), pool), 64, 64);
    CHECK(n.x == doctest::Approx(0).epsilon(0.01).scale(1));
    CHECK(n.y / n.z == doctest::Approx(scale * std::tan(std::numbers::pi / 6)).epsilon(0.01));
  }
}

TEST_CASE("rays meet what stands in their way, from either side, and nothing else") {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  std::vector<Triangle> triangles(20, Triangle{0, 1, 2}); // one over the other: no way to split them
  triangles.push_back({3, 4, 5});
  const RayTree tree(positions, triangles);
  CHECK(tree.meets({0.2F, 0.2F, 1}, {0, 0, -1}));
  CHECK(tree.meets({0.2F, 0.2F, 1}, {0, 0, 1}));
  CHECK(tree.meets({0.2F, 0.2F, -1}, {0, 0, 1}));
  CHECK_FALSE(tree.meets({0.2F, 0.2F, -1}, {0, 0, -1})); // behind
  CHECK_FALSE(tree.meets({0.8F, 0.8F, 1}, {0, 0, -1}));  // beside
  CHECK_FALSE(tree.meets({2, 2, 1}, {1, 1, 0.01F}));
}

TEST_CASE("rays go through the backs of single sides, but for those of their own component, and through what masks "
          "leave out") {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; // seen from +z
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const Vec3f up{0, 0, 1}, down{0, 0, -1}, above{0.2F, 0.2F, 1}, below{0.2F, 0.2F, -1};
  const OccluderTree one_sided(positions, triangles, {{7, false, Occluder::none}});
  CHECK(one_sided.hides(above, down, 0));
  CHECK_FALSE(one_sided.hides(below, up, 0));
  CHECK(one_sided.hides(below, up, 7));

  Image left_half{2, 1, 4, {0, 0, 0, 255, 0, 0, 0, 100}};
  const Sampler sampler(left_half, Wrap::repeat, Wrap::repeat, 1);
  AlphaMask mask{&sampler, {RasterPoint{0, 0}, {2, 0}, {0, 1}}, {1, 1, 1}, 0.5F};
  const auto hides = [&](float x) {
    const OccluderTree tree(positions, triangles, {{7, true, 0}}, {mask});
    return tree.hides({x, 0.2F, 1}, down, 0) && tree.hides({x, 0.2F, -1}, up, 0);
  };
  CHECK(hides(0.4F));
  CHECK_FALSE(hides(0.6F));
  mask.cutoff = 0.3F;
  CHECK(hides(0.6F));
  mask.alpha = {0.5F, 0.5F, 0.5F};
  CHECK_FALSE(hides(0.6F));
  CHECK_FALSE(OccluderTree({}, {}).hides(above, down, 0)); // nothing
}

TEST_CASE("a plain sees the whole sky, and half of it at the foot of a high wall") {
  const Sheet sheet(1);
  const auto positions = sheet.corners<Vec3f>([&](std::uint32_t v) { return Vec3f{sheet.uv[v].x, sheet.uv[v].y, 0}; });
  const auto normals = sheet.corners<Vec3f>([](std::uint32_t) { return Vec3f{0, 0, -1}; });
  ThreadPool pool(2);
  const TexelMap map(sheet.page(), 32, 32, pool);
  const std::vector<Vec3f> wall{{0.1F, -1e4F, -1e4F}, {0.1F, 1e4F, -1e4F}, {0.1F, 0, 1e4F}};
  const std::vector<Vec3f> ground{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangle{{0, 1, 2}};
  const std::vector<OccluderTree> trees{OccluderTree(ground, triangle), OccluderTree(wall, triangle)};
  for (const std::uint32_t which : {0U, 1U}) {
    const std::vector<std::uint32_t> tree_of(sheet.triangles.size(), which);
    const Image image =
        bake_occlusion(map, positions, normals, {trees, tree_of, tree_of}, {}, 1e-4F, NoProgress(), pool);
    for (std::uint32_t y = 0; y < 32; ++y)
      for (std::uint32_t x = 0; x < 32; ++x)
        CHECK(std::abs(image.at(x, y)[0] - (which == 0 ? 255 : 128)) <= (which == 0 ? 0 : 20));
  }
}

TEST_CASE("a sheet that is seen from both sides has the occlusion of its open side") {
  const Sheet sheet(1);
  const auto positions = sheet.corners<Vec3f>([&](std::uint32_t v) { return Vec3f{sheet.uv[v].x, sheet.uv[v].y, 0}; });
  const auto normals = sheet.corners<Vec3f>([](std::uint32_t) { return Vec3f{0, 0, -1}; });
  ThreadPool pool(2);
  const TexelMap map(sheet.page(), 16, 16, pool);
  // A wide floor close to its front.
  const std::vector<Vec3f> floor{{-1e4F, -1e4F, -0.01F}, {2e4F, -1e4F, -0.01F}, {0, 2e4F, -0.01F}};
  const std::vector<OccluderTree> trees{OccluderTree(floor, std::vector<Triangle>{{0, 1, 2}})};
  const std::vector<std::uint32_t> tree_of(sheet.triangles.size(), 0);
  for (const bool two_sided : {false, true}) {
    const Image image = bake_occlusion(map, positions, normals, {trees, tree_of, tree_of},
                                       std::vector<bool>(sheet.triangles.size(), two_sided), 1e-4F, NoProgress(), pool);
    CHECK(image.at(8, 8)[0] == (two_sided ? 255 : 0));
  }
}
