// OBJ, PLY and STL: the same tetrahedron in each, and what each can say beyond it.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>

#include "core/asset/asset.h"
#include "core/asset/polygon.h"
#include "support/unchanged.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;

namespace {

Asset read(const test::Bytes& bytes, const Attachments& files = {}) { return read_asset(bytes, files, Limits{}); }
Asset read(std::string_view text, const Attachments& files = {}) { return read(bytes_of(text), files); }

Error error_of(std::string_view text, const Attachments& files = {}) {
  try {
    (void)read(text, files);
  } catch (const Error& error) {
    return error;
  }
  FAIL("the file was read");
  return Error(ErrorCode::internal, "unreachable");
}

bool has_note(const Asset& asset, std::string_view code) {
  return std::any_of(asset.notes.begin(), asset.notes.end(), [&](const auto& note) { return note.code == code; });
}

constexpr std::string_view obj = "# a tetrahedron\n"
                                 "v 1 1 1\nv -1 -1 1\nv -1 1 -1\r\nv 1 -1 -1\n"
                                 "f 1 3 2\nf 1 2 4\nf 1 4 3\nf -3 -2 -1\n";

constexpr std::string_view ply_text = "ply\nformat ascii 1.0\ncomment made by hand\n"
                                      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                                      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
                                      "1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n"
                                      "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

constexpr std::string_view stl_text = "solid t\n"
                                      "facet normal 0 0 0\nouter loop\nvertex 1 1 1\nvertex -1 1 -1\nvertex -1 -1 1\n"
                                      "endloop\nendfacet\n"
                                      "facet normal 0 0 0\nouter loop\nvertex 1 1 1\nvertex -1 -1 1\nvertex 1 -1 -1\n"
                                      "endloop\nendfacet\n"
                                      "facet normal 0 0 0\nouter loop\nvertex 1 1 1\nvertex 1 -1 -1\nvertex -1 1 -1\n"
                                      "endloop\nendfacet\n"
                                      "facet normal 0 0 0\nouter loop\nvertex -1 -1 1\nvertex -1 1 -1\n"
                                      "vertex 1 -1 -1\nendloop\nendfacet\nendsolid t\n";

test::Bytes little_endian(std::uint32_t value, std::size_t size = 4) {
  test::Bytes out;
  for (std::size_t i = 0; i < size; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  return out;
}

void append(test::Bytes& to, const test::Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }

test::Bytes stl_binary() {
  test::Bytes out = bytes_of("solid of a program that begins its binary files like this");
  out.resize(80);
  append(out, little_endian(4));
  for (std::size_t t = 0; t < 12; t += 3) {
    out.resize(out.size() + 12);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t v = test::tetrahedron_indices[t + corner];
      for (std::size_t c = 0; c < 3; ++c) {
        append(out, little_endian(std::bit_cast<std::uint32_t>(test::tetrahedron_positions[3 * v + c])));
      }
    }
    out.resize(out.size() + 2);
  }
  return out;
}

test::Bytes ply_binary(bool big_endian) {
  test::Bytes out = bytes_of(std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                             "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                             "element face 4\nproperty list uchar ushort vertex_index\nend_header\n");
  const auto add = [&](std::uint32_t value, std::size_t size) {
    test::Bytes bytes = little_endian(value, size);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    append(out, bytes);
  };
  for (const float x : test::tetrahedron_positions) add(std::bit_cast<std::uint32_t>(x), 4);
  for (std::size_t i = 0; i < 12; ++i) {
    if (i % 3 == 0) add(3, 1);
    add(test::tetrahedron_indices[i], 2);
  }
  return out;
}

void check_tetrahedron(const Asset& asset, ModelFormat format) {
  CHECK(asset.format == format);
  REQUIRE(asset.primitives.size() == 1);
  CHECK(asset.primitives[0].vertex_count() == 4);
  REQUIRE(asset.primitives[0].indices.size() == 12);
  const std::vector<Vec3f> p = asset.primitives[0].positions();
  double volume = 0;
  for (std::size_t i = 0; i < 12; i += 3) {
    const auto& n = asset.primitives[0].indices;
    volume += double{dot(p[n[i]], cross(p[n[i + 1]], p[n[i + 2]]))} / 6;
  }
  CHECK(std::abs(volume) == doctest::Approx(8.0 / 3));
}

} // namespace

TEST_CASE("the same tetrahedron is read from OBJ, PLY in all its forms, and STL in both of its own") {
  check_tetrahedron(read(obj), ModelFormat::obj);
  check_tetrahedron(read(ply_text), ModelFormat::ply);
  check_tetrahedron(read(ply_binary(false)), ModelFormat::ply);
  check_tetrahedron(read(ply_binary(true)), ModelFormat::ply);
  check_tetrahedron(read(stl_text), ModelFormat::stl);
  check_tetrahedron(read(stl_binary()), ModelFormat::stl);
}

TEST_CASE("another format comes out as glTF, with a document that is whole") {
  const Asset asset = read(obj);
  const Bytes glb = test::write_unchanged(asset);
  const Asset again = read_asset(glb, {}, Limits{});
  CHECK(again.primitives.at(0).indices == asset.primitives[0].indices);
  CHECK(again.primitives.at(0).attributes.at(0).data == asset.primitives[0].attributes.at(0).data);
}

TEST_CASE("OBJ: a corner is a vertex for each texture coordinate; objects are meshes, materials primitives") {
  const Attachments files{
      {"m.mtl", bytes_of("newmtl red\nKd 1 0 0\nd 0.5\nnewmtl pic\nKd 0 0 0\nmap_Kd -s 1 1 1 tex\\a.png\n")},
      {"a.png", test::tiny_png()}};
  const Asset asset = read("mtllib m.mtl\n"
                           "o one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvt 1 1\nvn 0 0 2\n"
                           "usemtl red\nf 1/1/1 2/2/1 3/1/1\nusemtl pic\nf 1/1 3/2 4/1\n"
                           "o two\nusemtl red\nf 1 2 3 4\n",
                           files);
  REQUIRE(asset.primitives.size() == 3);
  CHECK(asset.primitives[0].mesh == 0);
  CHECK(asset.primitives[2].mesh == 1);
  CHECK(asset.primitives[0].material == asset.primitives[2].material);
  CHECK(asset.primitives[0].material != asset.primitives[1].material);
  const Attribute* uv = asset.primitives[0].find("TEXCOORD_0");
  REQUIRE(uv);
  CHECK(uv->get(0, 1) == 0.75); // v counts downward in glTF
  const Attribute* normal = asset.primitives[0].find("NORMAL");
  REQUIRE(normal);
  CHECK(normal->get(0, 2) == 1.0);
  CHECK(asset.primitives[2].indices.size() == 6); // a quadrilateral
  const auto color = material_texture(asset, asset.primitives[1], TextureSlot::base_color);
  REQUIRE(color.has_value());
  CHECK(std::ranges::equal(color->image, test::tiny_png()));
}

TEST_CASE("OBJ: colours behind positions are sRGB, and linear in glTF") {
  const Asset asset = read("v 0 0 0 1 0 0.5\nv 1 0 0 1 0 0.5\nv 0 1 0 1 0 0.5\nf 1 2 3\n");
  const Attribute* color = asset.primitives.at(0).find("COLOR_0");
  REQUIRE(color);
  CHECK(color->get(2, 0) == 1.0);
  CHECK(color->get(2, 2) == doctest::Approx(0.2140).epsilon(0.001));
}

TEST_CASE("OBJ: vertices without a colour take none from the others") {
  // Once, no vertex after one without a colour had any.
  const Asset asset = read("v 0 0 1\nv 0 0 0\nv 1 0 0 1 0 0.5\nv 0 1 0 0 0 0\nf 2 3 4\n"
                           "o plain\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 5 6 7\n");
  const Attribute* color = asset.primitives.at(0).find("COLOR_0");
  REQUIRE(color);
  CHECK(vector_at(*color, 0) == Vec3d(1, 1, 1));
  CHECK(color->get(1, 2) == doctest::Approx(0.2140).epsilon(0.001));
  CHECK(vector_at(*color, 2) == Vec3d(0, 0, 0));
  CHECK_FALSE(asset.primitives.at(1).find("COLOR_0"));
}

TEST_CASE("OBJ and MTL: a byte order mark hides nothing of the first line") {
  const Asset asset = read("\xEF\xBB\xBFmtllib m.mtl\nusemtl red\n" + std::string(obj),
                           {{"m.mtl", bytes_of("\xEF\xBB\xBFnewmtl red\nKd 1 0 0\n")}});
  CHECK(asset.primitives.at(0).material.has_value());
  CHECK(asset.notes.empty());
}

TEST_CASE("OBJ: a library that was forgotten is named; a model that came alone goes without") {
  const std::string text = "mtllib m.mtl\nusemtl a\n" + std::string(obj);
  CHECK(has_note(read(text), "materials-missing"));
  const Error error = error_of(text, {{"other.mtl", bytes_of("newmtl a\n")}});
  CHECK(error.code() == ErrorCode::missing_resource);
  CHECK(error.message().find("'m.mtl'") != std::string::npos);
}

TEST_CASE("OBJ: what is wrong is told with its line") {
  const auto tells = [](std::string_view text, std::string_view what) {
    const Error error = error_of(text);
    CAPTURE(error.message());
    CHECK(error.code() == ErrorCode::malformed);
    CHECK(error.message().find(what) != std::string::npos);
  };
  tells("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "line 4: the face names position 9, but there are 3");
  tells("v 0 0 0\nf 1 0 1\n", "names position 0");
  tells("v 0 zero 0\n", "line 1: 'zero' is not a number");
  tells("v 0 0\n", "a number is missing");
  tells("v 0 0 0\nf 1 1\n", "fewer than three corners");
  tells("v 0 0 0\nf 1/1/1/1 1 1\n", "no corner of a face");
  tells("v 0 0 0\nf 1/2 1 1\n", "texture coordinate 2");
  CHECK(error_of("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").code() == ErrorCode::invalid_geometry);
  CHECK(has_note(read(std::string(obj) + "l 1 2\np 1\n"), "elements-left-out"));
}

TEST_CASE("PLY: normals, colours and texture coordinates come along, others get a note") {
  const Asset asset =
      read("ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\n"
           "property double x\nproperty double y\nproperty double z\n"
           "property float nx\nproperty float ny\nproperty float nz\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
           "property float s\nproperty float t\nproperty float quality\n"
           "element edge 1\nproperty int a\nproperty int b\n"
           "element face 1\nproperty list uchar uint vertex_indices\nproperty list uchar float texcoord\n"
           "end_header\n"
           "0 0 0 0 0 1 255 0 128 255 0 0.25 7\n"
           "1 0 0 0 0 1 255 0 128 255 0 0.25 7\n"
           "0 1 0 0 0 1 255 0 128 0 0 0.25 7\n"
           "4 5\n"
           "3 0 1 2 6 0 0 1 0 0 1\n",
           {{"a.png", test::tiny_png()}});
  const Primitive& p = asset.primitives.at(0);
  REQUIRE(p.find("COLOR_0"));
  CHECK(p.find("COLOR_0")->components == 4);
  CHECK(p.find("COLOR_0")->get(2, 3) == 0.0);
  REQUIRE(p.find("TEXCOORD_0"));
  CHECK(p.find("TEXCOORD_0")->get(0, 1) == 0.75);
  CHECK(p.find("NORMAL"));
  CHECK(material_texture(asset, p, TextureSlot::base_color).has_value());
  CHECK(has_note(asset, "property-not-carried-over"));
}

TEST_CASE("PLY: counts that the file cannot hold, and indices that lead nowhere, are refused") {
  std::string lie(ply_text);
  lie.replace(lie.find("vertex 4"), 8, "vertex 4000000000");
  CHECK(error_of(lie).message().find("too short") != std::string::npos);
  std::string index(ply_text);
  index.replace(index.find("3 0 2 1"), 7, "3 0 2 7");
  CHECK(error_of(index).code() == ErrorCode::malformed);
  std::string polygon(ply_text);
  polygon.replace(polygon.find("3 0 2 1"), 7, "999999999 0 2 1");
  CHECK(error_of(polygon).code() == ErrorCode::malformed);
  test::Bytes cut = ply_binary(false);
  cut.resize(cut.size() - 5);
  CHECK_THROWS_AS(read(cut), Error);
  CHECK(error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                 "end_header\n0 0 0\n")
            .code() == ErrorCode::invalid_geometry);
}

TEST_CASE("STL: a file that ends within a solid is refused") {
  CHECK(error_of(stl_text.substr(0, 300)).code() == ErrorCode::malformed);
  CHECK(error_of("solid t\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n")
            .code() == ErrorCode::malformed);
}

TEST_CASE("polygons: n - 2 triangles that cover the polygon once, whatever its shape and direction") {
  const std::vector<Vec3f> shapes[]{
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
      {{0, 0, 0}, {3, 0, 0}, {1, 1, 0}, {0, 3, 0}},                                             // an arrow
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}},                                  // a notch
      {{0, 0, 0}, {0, 3, 0}, {0, 3, 3}, {0, 2, 3}, {0, 2, 1}, {0, 1, 1}, {0, 1, 3}, {0, 0, 3}}, // a U, standing
  };
  for (std::vector<Vec3f> shape : shapes) {
    for (int turned = 0; turned < 2; ++turned) {
      const std::vector<std::uint32_t> triangles = triangulate_polygon(shape);
      REQUIRE(triangles.size() == 3 * (shape.size() - 2));
      Vec3f whole, sum;
      float areas = 0;
      for (std::size_t i = 0; i < shape.size(); ++i) whole += cross(shape[i], shape[(i + 1) % shape.size()]);
      for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const Vec3f& a = shape[triangles[t]];
        const Vec3f n = cross(shape[triangles[t + 1]] - a, shape[triangles[t + 2]] - a);
        sum += n;
        areas += norm(n);
      }
      CHECK(norm(sum - whole) < 1e-5f);
      CHECK(areas == doctest::Approx(double{norm(whole)})); // no triangle lies upside down
      std::reverse(shape.begin(), shape.end());
    }
  }
}

TEST_CASE("polygons: one that crosses itself still gives as many triangles") {
  CHECK(triangulate_polygon(std::vector<Vec3f>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}).size() == 9);
}

TEST_CASE("formats are told by content") {
  CHECK(recognise("glTF", 4) == ModelFormat::glb);
  CHECK(recognise(" \n{", 3) == ModelFormat::gltf);
  CHECK(recognise("PK\x03\x04", 4) == ModelFormat::zip);
  CHECK(recognise("# a comment\n\nmtllib a.mtl\n", 100) == ModelFormat::obj);
  CHECK(recognise("# nothing but comments, so far", 100'000) == ModelFormat::obj);
  CHECK(recognise("solid x\nfacet", 100) == ModelFormat::stl);
  CHECK_FALSE(recognise("value: 1\n", 9).has_value());
  CHECK_FALSE(recognise("\x01\x02\x03", 3).has_value());
  CHECK_FALSE(recognise("", 0).has_value());

  std::string four_triangles(84, '\0');
  four_triangles[80] = 4;
  CHECK(recognise(four_triangles, 284) == ModelFormat::stl);
  CHECK_FALSE(recognise(four_triangles, 250).has_value());
  CHECK(unrecognised(four_triangles, 250).find("counts 4 triangles, which take 284 bytes, but there are 250") !=
        std::string::npos);
  std::string anything = four_triangles; // bytes that happen to count a billion triangles
  anything[83] = 0x42;
  CHECK(unrecognised(anything, 6'000'000).find("STL:") == std::string::npos);
  CHECK(unrecognised(std::string(200, 'x'), 200).find("STL:") == std::string::npos);
}
