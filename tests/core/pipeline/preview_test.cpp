// The picture of the result: the scene with every instance, in the materials' colours.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

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

namespace {

// A square from -1 to 1 that faces +Z, with vertex colours of this alpha.
GltfBuilder square(const std::array<float, 3>& color, float alpha) {
  GltfBuilder b;
  const auto position = b.add_accessor(std::vector<float>{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3", 3);
  b.json["accessors"][position]["min"] = {-1, -1, 0};
  b.json["accessors"][position]["max"] = {1, 1, 0};
  std::vector<float> colors;
  for (int i = 0; i < 4; ++i) colors.insert(colors.end(), {color[0], color[1], color[2], alpha});
  const auto indices = b.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 1);
  b.add_mesh(Json{{"attributes", {{"POSITION", position}, {"COLOR_0", b.add_accessor(colors, "VEC4", 4)}}},
                  {"indices", indices},
                  {"material", b.append("materials", Json::object())}});
  return b;
}

constexpr std::array<float, 3> red{1, 0.05F, 0.05F};

std::size_t red_pixels_of_model(const GltfBuilder& b) {
  const texture::Image image = preview_of(b);
  return red_pixels(image, image.width / 2, image.width);
}

} // namespace

TEST_CASE("the preview leaves out what a mask does, by the alpha of vertex colours and material") {
  GltfBuilder b = square(red, 0.6F);
  CHECK(red_pixels_of_model(b) > 10000);
  b.json["materials"][0] = {{"alphaMode", "MASK"}};
  CHECK(red_pixels_of_model(b) > 10000);
  b.json["materials"][0]["alphaCutoff"] = 0.7;
  CHECK(red_pixels_of_model(b) == 0);
  b.json["materials"][0] = {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.7}}}}};
  CHECK(red_pixels_of_model(b) == 0);
}

// A file that tests renderers (NegativeScaleTest) had shown red crosses: the backs of squares that mark failure.
TEST_CASE("the preview leaves out back faces, of nodes that mirror their mesh too") {
  GltfBuilder b = square(red, 1);
  Json& node = b.json["nodes"][0];
  CHECK(red_pixels_of_model(b) > 10000);
  node["rotation"] = {0, 1, 0, 0};
  CHECK(red_pixels_of_model(b) == 0);
  node["scale"] = {1, 1, -1}; // turned and mirrored, its corners go clockwise, and that is the front of a mirrored mesh
  CHECK(red_pixels_of_model(b) > 10000);
  node.erase("rotation");
  CHECK(red_pixels_of_model(b) == 0);
  b.json["materials"][0]["doubleSided"] = true;
  CHECK(red_pixels_of_model(b) > 10000);
}

TEST_CASE("a second node that mirrors the mesh shows the sides as they are there") {
  GltfBuilder b = square(red, 1);
  const std::size_t other = b.append("nodes", Json{{"mesh", 0}, {"translation", {4, 0, 0}}, {"scale", {-1, 1, -1}}});
  b.json["scenes"][0]["nodes"].push_back(other);
  const std::size_t one = red_pixels_of_model(b); // the other is turned away
  b.json["nodes"][other]["scale"] = {-1, 1, 1};
  CHECK(red_pixels_of_model(b) > one * 3 / 2);
  b.json["nodes"][other]["scale"] = {1, 1, -1};
  CHECK(red_pixels_of_model(b) == one);
}

TEST_CASE("the preview shows the instances of a node, each with its own transform") {
  GltfBuilder b = square(red, 1);
  const std::size_t one = red_pixels_of_model(b);
  // Beside each other; one turned away, one mirrored, which is seen from the front.
  const auto places = b.add_accessor(std::vector<float>{0, 0, 0, 4, 0, 0, 8, 0, 0, 12, 0, 0}, "VEC3", 3);
  const auto turns = b.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC4", 4);
  const auto scales = b.add_accessor(std::vector<float>{1, 1, 1, 1, 1, 1, -1, 1, 1, 1, 1, 1}, "VEC3", 3);
  b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}, {"ROTATION", turns}, {"SCALE", scales}};
  const texture::Image image = preview_of(b);
  std::vector<std::uint32_t> columns;
  for (std::uint32_t x = image.width / 3; x < image.width; ++x)
    if (red_pixels(image, x, x + 1) > 0) columns.push_back(x);
  std::size_t gaps = 0, widest = 0;
  for (std::size_t i = 1; i < columns.size(); ++i) {
    const std::size_t gap = columns[i] - columns[i - 1] - 1;
    gaps += gap > 5 ? 1 : 0;
    widest = std::max<std::size_t>(widest, gap);
  }
  CHECK(gaps == 2); // three squares, and the place of the one that is turned away
  CHECK(widest > 60);
  CHECK(red_pixels_of_model(b) < one);
}

TEST_CASE("a model whose format does not tell sides apart is drawn from both") {
  const std::string text = "v -1 -1 0\nv -1 1 0\nv 1 1 0\nv 1 -1 0\nf 1 2 3 4\n"; // turned away from the viewer
  const test::Bytes obj = test::bytes_of(text);
  NoProgress progress;
  Request request{obj, {}, {}};
  request.options.texture_size = 64;
  const texture::Image image = asset::decode_image(process(request, {}, progress).preview_png, 1 << 24, "");
  std::size_t dark = 0; // the backdrop is brighter
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = image.width / 2; x < image.width; ++x) dark += image.at(x, y)[1] < 120 ? 1 : 0;
  CHECK(dark > 1000);
}

TEST_CASE("without normals of its own a model is shown flat, as renderers show it") {
  GltfBuilder b = colored_tetrahedron({1, 0.1, 0.1});
  const auto shades = [&] {
    const texture::Image image = preview_of(b);
    std::set<int> out; // of red, on the model
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = image.width / 2; x < image.width; ++x) {
        const std::uint8_t* p = image.at(x, y);
        if (p[0] > p[1] + 40) out.insert(p[0]);
      }
    return out.size();
  };
  const std::size_t flat = shades();
  std::vector<float> normals = test::tetrahedron_positions;
  for (float& x : normals) x /= std::sqrt(3.0F);
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.add_accessor(normals, "VEC3", 3);
  CHECK(shades() > 2 * flat);
}
