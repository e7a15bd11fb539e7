// Names in encodings other than UTF-8, which OBJ, MTL, PLY, STL and zip do not declare: once, one byte of Latin-1 in a
// material's name ended the job with an internal error, since JSON must be UTF-8.
#include <doctest/doctest.h>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "core/asset/uri.h"
#include "core/utf8.h"
#include "support/unchanged.h"
#include "support/zip_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;

namespace {

constexpr std::string_view faces = "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                   "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n";

// "Körper", "Haut" with an umlaut and "tür.png", in Latin-1.
const std::string latin_obj = "mtllib f\xfcr.mtl\no K\xf6rper\nusemtl H\xe4ut\n" + std::string(faces);
const test::Bytes latin_mtl = bytes_of("newmtl H\xe4ut\nmap_Kd t\xfcr.png\nmap_Ks gl\xe4nzend.png\n");

bool has_note(const Asset& asset, std::string_view code) {
  return std::any_of(asset.notes.begin(), asset.notes.end(), [&](const auto& note) { return note.code == code; });
}

void check_all_is_there(const Asset& asset) {
  const Json& json = asset.document->json;
  CHECK(json["nodes"][0]["name"] == "Körper");
  CHECK(json["materials"][0]["name"] == "Häut");
  CHECK(json["images"][0]["name"] == "tür.png");
  CHECK(material_texture(asset, asset.primitives.at(0), TextureSlot::base_color).has_value());
  CHECK_NOTHROW(test::write_unchanged(asset));
  for (const Asset::Note& note : asset.notes) CHECK(as_utf8(note.message) == note.message);
}

} // namespace

TEST_CASE("as_utf8 keeps what is UTF-8 and takes every other byte for Latin-1") {
  CHECK(as_utf8("a \u00e9 \u20ac \U0001f600") == "a \u00e9 \u20ac \U0001f600");
  CHECK(as_utf8("caf\xe9") == "caf\u00e9");
  CHECK(as_utf8("\xe2\x82") == "\u00e2\u0082");                     // cut short
  CHECK(as_utf8("\xc0\xaf") == "\u00c0\u00af");                     // overlong
  CHECK(as_utf8("\xed\xa0\x80") == "\u00ed\u00a0\u0080");           // a surrogate
  CHECK(as_utf8("\xf4\x90\x80\x80") == "\u00f4\u0090\u0080\u0080"); // beyond the last character
  CHECK(as_utf8("\xe9\u00e9") == "\u00e9\u00e9");
  CHECK(as_utf8("").empty());
}

TEST_CASE("what messages show is UTF-8, also where it was cut") {
  for (std::size_t n = 70; n < 90; ++n) {
    const std::string text = shown(std::string(n, 'x') + "\u20ac\u20ac\u20ac\u20ac\u20ac\u20ac\u20ac");
    CHECK(as_utf8(text) == text);
    const std::string latin = shown(std::string(n, '\xe9'));
    CHECK(as_utf8(latin) == latin);
    CHECK(latin.size() <= 80 + std::string_view("…").size());
  }
}

TEST_CASE("OBJ: names in Latin-1 come out in UTF-8, and lead to libraries, materials and images by their bytes") {
  check_all_is_there(
      read_asset(bytes_of(latin_obj), {{"f\xfcr.mtl", latin_mtl}, {"t\xfcr.png", test::tiny_png()}}, Limits{}));
}

TEST_CASE("OBJ: a file named in Latin-1 is found under the same name in UTF-8, as browsers send it") {
  check_all_is_there(
      read_asset(bytes_of(latin_obj), {{"für.mtl", latin_mtl}, {"tür.png", test::tiny_png()}}, Limits{}));
}

TEST_CASE("OBJ: materials whose names differ in bytes are two, whatever the names become") {
  const Asset asset =
      read_asset(bytes_of("mtllib m.mtl\nusemtl \xe9\n" + std::string(faces) + "usemtl \u00e9\nf 1 2 3\n"),
                 {{"m.mtl", bytes_of("newmtl \xe9\nKd 1 0 0\nnewmtl \u00e9\nKd 0 1 0\n")}}, Limits{});
  const Json& materials = asset.document->json["materials"];
  REQUIRE(materials.size() == 2);
  CHECK(materials[0]["pbrMetallicRoughness"]["baseColorFactor"][0] == 1.0);
  CHECK(materials[1]["pbrMetallicRoughness"]["baseColorFactor"][0] == 0.0);
}

TEST_CASE("OBJ: what is missing is named in UTF-8") {
  const Asset asset = read_asset(bytes_of(latin_obj), {}, Limits{});
  REQUIRE(has_note(asset, "materials-missing"));
  CHECK(asset.notes[0].message.find("'für.mtl'") != std::string::npos);
}

TEST_CASE("STL and PLY: names that are no UTF-8 are no error") {
  const Asset stl =
      read_asset(bytes_of("solid \x83\x65\x83\x58\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                          "vertex 0 1 0\nendloop\nendfacet\nendsolid\n"),
                 {}, Limits{});
  CHECK(stl.document->json["nodes"][0]["name"] == "\u0083e\u0083X");
  CHECK_NOTHROW(test::write_unchanged(stl));
  const Asset ply =
      read_asset(bytes_of("ply\nformat ascii 1.0\ncomment gr\xfc\xdf"
                          "e\ncomment TextureFile t\xfcr.png\nelement vertex 3\n"
                          "property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
                          "property float g\xfcte\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                          "0 0 0 0 0 1\n1 0 0 1 0 1\n0 1 0 0 1 1\n3 0 1 2\n"),
                 {{"t\xfcr.png", test::tiny_png()}}, Limits{});
  CHECK(ply.document->json["images"][0]["name"] == "tür.png");
  for (const Asset::Note& note : ply.notes) CHECK(as_utf8(note.message) == note.message);
}

TEST_CASE("glTF: strings that are no UTF-8 are refused as the syntax errors that they are") {
  std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"name":"caf?"}]})";
  text[text.find('?')] = '\xe9';
  try {
    (void)read_asset(bytes_of(text), {}, Limits{});
    FAIL("the file was read");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::malformed);
    CHECK(error.message().find("syntax error") != std::string::npos);
  }
}

TEST_CASE("zip: members whose names are no UTF-8 are found by an OBJ's bytes, and by what the archive takes them for") {
  const test::Bytes zip = test::zip_of(
      {{"m\xfc/a.obj", bytes_of(latin_obj)}, {"m\xfc/f\xfcr.mtl", latin_mtl}, {"m\xfc/t\xfcr.png", test::tiny_png()}});
  check_all_is_there(read_asset(zip, {}, Limits{}));
  test::GltfBuilder gltf = test::tetrahedron();
  gltf.append("images", {{"uri", "\u00fc.png"}});
  const test::Bytes old = test::zip_of({{"a.glb", gltf.glb()}, {"\x81.png", test::tiny_png()}}); // code page 437
  CHECK_FALSE(has_note(read_asset(old, {}, Limits{}), "image-missing"));
}
