// PLY: what belongs to faces and their corners, as MeshLab writes it.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "support/unchanged.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;

namespace {

Asset read(const std::string& text, const Attachments& files = {}) {
  return read_asset(bytes_of(text), files, Limits{});
}

// A square of two triangles; `comments` and `properties` go to the header, `faces` are the rows behind the vertices.
std::string square(const std::string& comments, const std::string& properties, const std::string& faces,
                   std::size_t count = 2) {
  return "ply\nformat ascii 1.0\n" + comments +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_indices\n" + properties +
         "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces;
}

std::size_t notes_about(const Asset& asset, std::string_view what) {
  return static_cast<std::size_t>(std::count_if(asset.notes.begin(), asset.notes.end(), [&](const auto& note) {
    return note.message.find(what) != std::string::npos;
  }));
}

// The texture coordinates at a position of a triangle.
Vec2f texcoord_at(const Primitive& p, std::size_t triangle, const Vec3f& position) {
  const std::vector<Vec3f> positions = p.positions();
  const Attribute* uv = p.find("TEXCOORD_0");
  REQUIRE(uv);
  for (std::size_t i = 3 * triangle; i < 3 * triangle + 3; ++i) {
    const std::uint32_t v = p.indices[i];
    if (positions[v] == position) return {static_cast<float>(uv->get(v, 0)), static_cast<float>(uv->get(v, 1))};
  }
  FAIL("the triangle has no such corner");
  return {};
}

const std::string wedge = "property list uchar float texcoord\n";

} // namespace

TEST_CASE("PLY: texture coordinates of corners split the vertices where they differ, and nowhere else") {
  const Asset asset = read(
      square("comment TextureFile a.png\n", wedge, "3 0 1 2 6 0 0 0.5 0 0.5 0.25\n3 0 2 3 6 0 0 0.75 0.25 0.75 1\n"),
      {{"a.png", test::tiny_png()}});
  REQUIRE(asset.primitives.size() == 1);
  const Primitive& p = asset.primitives[0];
  CHECK(p.vertex_count() == 5);                              // vertex 2 is two
  CHECK(texcoord_at(p, 0, {1, 1, 0}) == Vec2f{0.5F, 0.75F}); // v counts downward in glTF
  CHECK(texcoord_at(p, 1, {1, 1, 0}) == Vec2f{0.75F, 0.75F});
  CHECK(texcoord_at(p, 1, {0, 1, 0}) == Vec2f{0.75F, 0.0F});
  const auto color = material_texture(asset, p, TextureSlot::base_color);
  REQUIRE(color.has_value());
  CHECK(std::ranges::equal(color->image, test::tiny_png()));
  CHECK(asset.notes.empty());
}

TEST_CASE("PLY: a polygon's corners keep their texture coordinates when it becomes triangles") {
  const Asset asset = read(square("", wedge, "4 0 1 2 3 8 0 0 1 0.1 1 1 0 0.9\n", 1));
  const Primitive& p = asset.primitives.at(0);
  CHECK(p.vertex_count() == 4);
  const std::vector<Vec3f> positions = p.positions();
  for (std::size_t v = 0; v < 4; ++v) {
    CHECK(p.find("TEXCOORD_0")->get(v, 0) == double{positions[v].x});
    const double up = positions[v].y == 0 ? 0.1 * double{positions[v].x} : 0.9 + 0.1 * double{positions[v].x};
    CHECK(p.find("TEXCOORD_0")->get(v, 1) == doctest::Approx(1 - up));
  }
  CHECK_FALSE(p.material.has_value());
}

TEST_CASE("PLY: texnumber chooses among several textures; -1, and a list of another length, mean none") {
  const Asset asset =
      read(square("comment TextureFile a.png\ncomment TextureFile b.png\n", wedge + "property int texnumber\n",
                  "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 6 0 0 1 1 0 1 0\n"
                  "3 0 1 2 6 0 0 1 0 1 1 -1\n3 0 1 2 0 1\n3 0 1 2 6 0 0 1 0 1 1 7\n",
                  5),
           {{"a.png", test::tiny_png()}, {"b.png", test::tiny_png()}});
  REQUIRE(asset.primitives.size() == 3);
  const Json& json = asset.document->json;
  const auto image_name = [&](const Primitive& p) {
    const auto texture = material_texture(asset, p, TextureSlot::base_color);
    return texture ? json["images"][texture->image_number]["name"].get<std::string>() : "";
  };
  CHECK(image_name(asset.primitives[0]) == "a.png");
  CHECK(texcoord_at(asset.primitives[0], 0, {0, 1, 0}) == Vec2f{0, 0});
  CHECK(image_name(asset.primitives[1]) == "b.png");
  CHECK(asset.primitives[2].indices.size() == 9);
  CHECK_FALSE(asset.primitives[2].material.has_value());
  CHECK_FALSE(asset.primitives[2].find("TEXCOORD_0"));
}

TEST_CASE("PLY: colours of faces become colours of vertices, split where they differ") {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  const Asset asset = read(square("", colors, "3 0 1 2 255 0 128 255\n3 0 2 3 0 255 0 51\n"));
  const Primitive& p = asset.primitives.at(0);
  CHECK(p.vertex_count() == 6);
  const Attribute* color = p.find("COLOR_0");
  REQUIRE(color);
  REQUIRE(color->components == 4);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(color->get(p.indices[i], 0) == 1.0);
    CHECK(color->get(p.indices[i], 2) == doctest::Approx(0.2159).epsilon(0.001)); // linear
    CHECK(color->get(p.indices[3 + i], 1) == 1.0);
    CHECK(color->get(p.indices[3 + i], 3) == doctest::Approx(0.2).epsilon(0.001)); // alpha is no colour
  }
  const Asset plain = read(square("", colors, "3 0 1 2 9 9 9 255\n3 0 2 3 9 9 9 255\n"));
  CHECK(plain.primitives.at(0).vertex_count() == 4);
}

TEST_CASE("PLY: what vertices have comes before what faces have; what is skipped is told") {
  const Asset asset = read("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                           "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
                           "property uchar green\nproperty uchar blue\nproperty int flags\n"
                           "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
                           "element nothing 0\nproperty int a\nend_header\n"
                           "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2 0 0 0 5\n0 1\n");
  CHECK(asset.primitives.at(0).vertex_count() == 3);
  CHECK(asset.primitives.at(0).find("COLOR_0")->get(0, 0) == 1.0);
  CHECK(notes_about(asset, "face property 'red'") == 1);
  CHECK(notes_about(asset, "face property 'flags'") == 1);
  CHECK(notes_about(asset, "1 rows of the element 'edge'") == 1);
  CHECK(notes_about(asset, "vertex_indices") == 0);
  CHECK(notes_about(asset, "nothing") == 0);
}
