// The picture of the result: the scene with every instance, in the materials' colours.
#include <doctest/doctest.h>

#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "support/gltf_builder.h"

using namespace orbis;
using test::GltfBuilder;
using test::Json;

namespace {

texture::Image preview_of(const GltfBuilder& b) {
  NoProgress progress;
  const test::Bytes glb = b.glb();
  Request request{glb, {}, {}};
  request.options.texture_size = 64;
  return asset::decode_image(process(request, {}, progress).preview_png, 1 << 24, "");
}

// A tetrahedron with vertex colours, which are the base colour then, in a material of this factor.
GltfBuilder colored_tetrahedron(const std::array<double, 3>& factor) {
  GltfBuilder b = test::tetrahedron();
  const auto colors = b.add_accessor(std::vector<float>(12, 0.9F), "VEC3", 3);
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["COLOR_0"] = colors;
  primitive["material"] = b.append(
      "materials", Json{{"pbrMetallicRoughness", {{"baseColorFactor", {factor[0], factor[1], factor[2], 1}}}}});
  return b;
}

// Pixels of the right half, where the model is, that are much redder than grey.
std::size_t red_pixels(const texture::Image& image, std::uint32_t from, std::uint32_t to) {
  std::size_t n = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = from; x < to; ++x) {
      const std::uint8_t* p = image.at(x, y);
      if (p[0] > p[1] + 40 && p[0] > p[2] + 40) ++n;
    }
  return n;
}

} // namespace

TEST_CASE("the preview has the base colour factor, on the model and on its sphere") {
  const texture::Image red = preview_of(colored_tetrahedron({1, 0.1, 0.1}));
  CHECK(red_pixels(red, 0, red.width / 2) > 10000);
  CHECK(red_pixels(red, red.width / 2, red.width) > 10000);
  const texture::Image white = preview_of(colored_tetrahedron({1, 1, 1}));
  CHECK(red_pixels(white, 0, white.width) == 0);
}

TEST_CASE("the preview shows a mesh at each of its nodes") {
  GltfBuilder b = colored_tetrahedron({1, 0.1, 0.1});
  // Seen from the front: far apart, so that each is small, with nothing between them.
  const std::size_t other = b.append("nodes", Json{{"mesh", 0}, {"translation", {12, 0, 0}}});
  b.json["scenes"][0]["nodes"].push_back(other);
  const texture::Image image = preview_of(b);
  std::vector<std::uint32_t> columns; // that show something red, right of the sphere
  for (std::uint32_t x = image.width / 3; x < image.width; ++x)
    if (red_pixels(image, x, x + 1) > 0) columns.push_back(x);
  REQUIRE(columns.size() > 20);
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < columns.size(); ++i) gaps += columns[i] > columns[i - 1] + 20 ? 1 : 0;
  CHECK(gaps >= 1);
}

TEST_CASE("a node whose place is beyond all numbers leaves its mesh where it is") {
  GltfBuilder b = colored_tetrahedron({1, 0.1, 0.1});
  b.json["nodes"][0]["scale"] = {1e308, 1e308, 1e308};
  b.json["nodes"][0]["children"] = {b.append("nodes", Json{{"mesh", 0}, {"scale", {1e30, 1e30, 1e30}}})};
  const texture::Image image = preview_of(b);
  CHECK(red_pixels(image, image.width / 2, image.width) > 10000);
}
