// Material libraries: the options of textures, and the maps that glTF has no place for.
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

// A triangle with the material "m", whose lines these are.
Asset read(const std::string& lines) {
  return read_asset(
      bytes_of("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"),
      {{"m.mtl", bytes_of("newmtl m\n" + lines)},
       {"a.png", test::tiny_png()},
       {"4", test::tiny_png()},
       {"two words.png", test::tiny_png()}},
      Limits{});
}

MaterialTexture texture_of(const Asset& asset, TextureSlot slot = TextureSlot::base_color) {
  const auto texture = material_texture(asset, asset.primitives.at(0), slot);
  REQUIRE(texture.has_value());
  return *texture;
}

// MTL's definition, with v upward: the place (u, v) shows the image at (su u + ou, sv v + ov).
void check_places(const std::string& options, double su, double sv, double ou, double ov) {
  CAPTURE(options);
  const MaterialTexture texture = texture_of(read("map_Kd " + options + " a.png\n"));
  const auto& m = texture.transform;
  for (const double u : {-0.5, 0.0, 0.3, 2.0}) {
    for (const double v : {0.0, 0.7, 1.0}) {
      const double down = 1 - v;
      CHECK(double{m[0]} * u + double{m[1]} * down + double{m[2]} == doctest::Approx(su * u + ou));
      CHECK(1 - (double{m[3]} * u + double{m[4]} * down + double{m[5]}) == doctest::Approx(sv * v + ov));
    }
  }
}

bool has_note(const Asset& asset, std::string_view what) {
  return std::any_of(asset.notes.begin(), asset.notes.end(),
                     [&](const auto& note) { return note.message.find(what) != std::string::npos; });
}

} // namespace

TEST_CASE("MTL: -s and -o place the image where they say, however many of their numbers are there") {
  check_places("-s 4 4 1 -o 0.25 0 0 -clamp on", 4, 4, 0.25, 0);
  check_places("-o 0.125 -0.75 0 -s 2 3 1", 2, 3, 0.125, -0.75);
  check_places("-s 2 5", 2, 5, 0, 0);
  check_places("-s 2", 2, 1, 0, 0);
  check_places("-o +0.5", 1, 1, 0.5, 0);
  check_places("-blendu off -o .5 .25 -texres 512 -s -1 0.5", -1, 0.5, 0.5, 0.25);
  check_places("", 1, 1, 0, 0);
}

TEST_CASE("MTL: the file behind the options is found, be its name a number or two words") {
  CHECK(read("map_Kd -s 2 2 4\n").document->json["images"][0]["name"] == "4");
  CHECK(read("map_Kd -s 2 two words.png\n").document->json["images"][0]["name"] == "two words.png");
  CHECK(read("map_Kd -mm 0 a.png\n").document->json["images"][0]["name"] == "a.png");
}

TEST_CASE("MTL: -clamp on ends the image at its border; the same image may repeat elsewhere") {
  const Asset asset = read("map_Kd -clamp on a.png\nmap_Ke -s 2 2 1 a.png\n");
  CHECK(texture_of(asset).wrap_s == 33071);
  CHECK(texture_of(asset).wrap_t == 33071);
  CHECK(texture_of(asset, TextureSlot::emissive).wrap_s == 10497);
  const Json& json = asset.document->json;
  CHECK(json["extensionsUsed"] == Json::array({"KHR_texture_transform"}));
  CHECK_FALSE(json.contains("extensionsRequired"));
  CHECK_FALSE(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].contains("clamp"));
  const Asset plain = read("map_Kd a.png\n");
  CHECK(texture_of(plain).wrap_s == 10497);
  CHECK_FALSE(plain.document->json.contains("extensionsUsed"));
  CHECK(plain.notes.empty());
}

TEST_CASE("MTL: -bm scales a normal map; options without a place in glTF are named") {
  const Asset asset = read("norm -bm 0.5 a.png\nmap_Kd -mm 0.1 0.9 -t 1 1 1 -imfchan r a.png\n");
  CHECK(texture_of(asset, TextureSlot::normal).scale == 0.5F);
  CHECK(has_note(asset, "the options -mm -t -imfchan of the diffuse map of the material 'm'"));
  CHECK(asset.notes.size() == 1);
  CHECK(read("map_Kd -mm 0 1 -t 0 0 0 -imfchan m -blendv off -bm 1 a.png\n").notes.empty());
}

TEST_CASE("MTL: every map without a place in glTF is named, but not where it repeats the diffuse map") {
  const Asset asset = read("map_Kd a.png\nmap_d cut.png\nmap_Ka dark.png\nmap_Ns shiny.png\nmap_Ps cloth.png\n"
                           "map_Ks b.png\nmap_Bump c.png\n");
  for (const char* map : {"opacity map 'cut.png'", "ambient map 'dark.png'", "specular exponent map 'shiny.png'",
                          "sheen map 'cloth.png'", "specular map 'b.png'", "bump map 'c.png'"}) {
    CAPTURE(map);
    CHECK(has_note(asset, map));
  }
  const Asset repeated = read("map_Kd a.png\nmap_d a.png\nmap_Ka a.png\n");
  CHECK(repeated.notes.empty());
  CHECK(repeated.document->json["materials"][0]["alphaMode"] == "BLEND");
}
