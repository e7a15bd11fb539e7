// A result looks as its input did where nothing was baked, and where something was: alpha, textures that stay, variants
// and animated properties.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "support/flat_png.h"
#include "support/gltf_builder.h"
#include "support/shapes.h"

using namespace orbis;
using test::flat_png;
using test::GltfBuilder;
using test::Json;

namespace {

std::size_t add_texture(GltfBuilder& b, const test::Bytes& image, const char* mime_type) {
  const auto source = b.append("images", Json{{"bufferView", b.add_view(image)}, {"mimeType", mime_type}});
  return b.append("textures", Json{{"source", source}});
}

// A sphere with a white material, normals and, where they are asked for, texture coordinates.
GltfBuilder ball(bool has_uv = true) {
  std::vector<float> positions, uv;
  std::vector<std::uint32_t> indices;
  const mesh::TriangleMesh m = shapes::sphere(3);
  for (const Vec3f& p : m.positions) {
    const Vec3f n = normalized(p);
    positions.insert(positions.end(), {n.x, n.y, n.z});
    uv.insert(uv.end(), {0.5F + 0.4F * n.x, 0.5F + 0.4F * n.y});
  }
  for (const auto& t : m.triangles) indices.insert(indices.end(), t.begin(), t.end());
  GltfBuilder b;
  Json attributes;
  attributes["POSITION"] = b.add_accessor(positions, "VEC3", 3);
  attributes["NORMAL"] = b.add_accessor(positions, "VEC3", 3);
  if (has_uv) attributes["TEXCOORD_0"] = b.add_accessor(uv, "VEC2", 2);
  const auto index = b.add_accessor(indices, "SCALAR", 1);
  b.add_mesh(Json{{"attributes", attributes}, {"indices", index}, {"material", 0}});
  b.append("materials", Json{{"name", "white"}});
  return b;
}

void add_colors(GltfBuilder& b, const std::vector<float>& rgba) {
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  const std::size_t position = primitive["attributes"]["POSITION"], count = b.json["accessors"][position]["count"];
  std::vector<float> colors;
  for (std::size_t v = 0; v < count; ++v) colors.insert(colors.end(), rgba.begin(), rgba.end());
  primitive["attributes"]["COLOR_0"] = b.add_accessor(colors, "VEC4", 4);
}

struct Run {
  Result result;
  Json json;

  [[nodiscard]] auto notes(std::string_view code) const {
    return std::ranges::count(result.report.notes, code, &Note::code);
  }
};

Run run(const GltfBuilder& b, const std::vector<std::pair<std::string, std::string>>& settings = {}) {
  NoProgress progress;
  const test::Bytes glb = b.glb();
  Request request{glb, {}, {}};
  request.options.texture_size = 128;
  for (const auto& [name, value] : settings) set_option(request.options, name, value);
  Run out{process(request, {}, progress), {}};
  const auto text = asset::split_glb(out.result.glb).json;
  out.json =
      Json::parse(reinterpret_cast<const char*>(text.data()), reinterpret_cast<const char*>(text.data()) + text.size());
  return out;
}

Json channel(const std::string& pointer) {
  return Json{{"sampler", 0},
              {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
}

void animate(GltfBuilder& b, const Json& channels) {
  const auto time = b.add_accessor(std::vector<float>{0, 1}, "SCALAR", 1);
  const auto values = b.add_accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "VEC3", 3);
  const Json samplers = Json::array({Json{{"input", time}, {"output", values}}});
  b.append("animations", Json{{"channels", channels}, {"samplers", samplers}});
  b.json["extensionsUsed"].push_back("KHR_animation_pointer");
}

std::vector<std::string> pointers_of(const Json& json) {
  std::vector<std::string> out;
  for (const Json& animation : json.value("animations", Json::array()))
    for (const Json& c : animation["channels"])
      if (c["target"].contains("extensions"))
        out.push_back(c["target"]["extensions"]["KHR_animation_pointer"]["pointer"]);
  return out;
}

} // namespace

TEST_CASE("the alpha of vertex colours is baked with them") {
  GltfBuilder b = ball();
  add_colors(b, {1, 0.5F, 1, 0.25F});
  b.json["materials"][0]["alphaMode"] = "BLEND";
  const Run out = run(b);
  REQUIRE(out.result.maps.size() == 1);
  const texture::Image image = asset::decode_image(out.result.maps[0].bytes, 1 << 24, "");
  REQUIRE(image.channels == 4);
  CHECK(image.at(20, 30)[0] == 255);
  CHECK(image.at(20, 30)[1] == 188); // half of the light
  CHECK(image.at(20, 30)[3] == 64);
}

TEST_CASE("a texture that cannot be decoded keeps its place, and the vertex colours theirs beside it") {
  GltfBuilder b = ball();
  add_colors(b, {0.5F, 0.5F, 0.5F, 1});
  const auto texture = add_texture(b, test::bytes_of("\x89PNG but no more"), "image/png");
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = texture;
  const Run out = run(b, {{"texture", "auto"}});
  CHECK(out.notes("texture-kept") == 1);
  CHECK(out.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] == Json{{"index", texture}});
  CHECK(out.json["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
}

TEST_CASE("where a texture reads a set that is missing, the atlas does not become that set") {
  GltfBuilder b = ball(false);
  const auto texture = add_texture(b, flat_png(9, 9, 9), "image/png");
  b.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", texture}, {"texCoord", 1}};
  const Run out = run(b, {{"maps", "normal"}});
  const Json& attributes = out.json["meshes"][0]["primitives"][0]["attributes"];
  REQUIRE(attributes.contains("TEXCOORD_2"));
  const asset::Asset file = asset::read_asset(out.result.glb, {}, {});
  for (const char* name : {"TEXCOORD_0", "TEXCOORD_1"}) {
    const asset::Attribute* set = file.primitives[0].find(name);
    REQUIRE(set != nullptr);
    for (std::size_t v = 0; v < set->count(); ++v) CHECK((set->get(v, 0) == 0 && set->get(v, 1) == 0));
  }
}

TEST_CASE("the two base colours of an older material are not taken for one") {
  for (const bool same : {true, false}) {
    GltfBuilder b = ball();
    const auto red = add_texture(b, flat_png(200, 0, 0), "image/png"),
               green = add_texture(b, flat_png(0, 200, 0), "image/png");
    b.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = red;
    b.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"]["index"] =
        same ? red : green;
    const Json material = run(b).json["materials"][0];
    const Json& base = material["pbrMetallicRoughness"]["baseColorTexture"];
    const Json& diffuse = material["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"];
    CHECK(base["texCoord"] == 1);
    CHECK((diffuse == base) == same);
    CHECK(diffuse.contains("texCoord") == same); // else on its own coordinates, set 0
  }
}

TEST_CASE("on levels every variant's material has the normal map that the level's normals are for") {
  GltfBuilder b = ball();
  b.append("materials", Json{{"name", "black"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}});
  b.json["extensionsUsed"] = {"KHR_materials_variants"};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = Json::array({Json{{"name", "a"}}, Json{{"name", "b"}}});
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
      Json::array({Json{{"material", 0}, {"variants", {0}}}, Json{{"material", 1}, {"variants", {1}}}});
  const Run out = run(b, {{"lods", "0.3"}});
  REQUIRE(out.json["meshes"].size() == 2);
  const Json& level = out.json["meshes"][1]["primitives"][0];
  const Json& mappings = level["extensions"]["KHR_materials_variants"]["mappings"];
  const auto material = [&](const Json& user) { return out.json["materials"][user["material"].get<std::size_t>()]; };
  REQUIRE(material(level).contains("normalTexture"));
  CHECK(mappings[0]["material"] == level["material"]);
  CHECK(material(mappings[1])["name"] == "black");
  CHECK(material(mappings[1])["normalTexture"] == material(level)["normalTexture"]);
  CHECK_FALSE(out.json["materials"][1].contains("normalTexture")); // the full surface's stays
}

TEST_CASE("levels of what keeps textures of its own say that these smear") {
  GltfBuilder plain = ball(), kept = ball();
  kept.json["extensionsUsed"] = {"KHR_materials_specular"};
  kept.json["materials"][0]["extensions"]["KHR_materials_specular"]["specularTexture"]["index"] =
      add_texture(kept, flat_png(9, 9, 9), "image/png");
  CHECK(run(plain, {{"lods", "0.3"}}).notes("level-texture-coordinates") == 0);
  CHECK(run(kept, {{"lods", "0.3"}}).notes("level-texture-coordinates") == 1);
  CHECK(run(kept).notes("level-texture-coordinates") == 0);
}

TEST_CASE("what animates a material animates its copies on levels") {
  GltfBuilder b = ball();
  animate(b, Json::array({channel("/materials/0/emissiveFactor")}));
  const Run out = run(b, {{"lods", "0.3"}});
  const auto level = out.json["meshes"][1]["primitives"][0]["material"].get<std::size_t>();
  REQUIRE(level != 0);
  CHECK(pointers_of(out.json) == std::vector<std::string>{"/materials/0/emissiveFactor",
                                                          "/materials/" + std::to_string(level) + "/emissiveFactor"});
}

TEST_CASE("a node that is moved by pointer takes its levels along") {
  GltfBuilder b = ball();
  animate(b, Json::array({channel("/nodes/0/translation")}));
  const Run out = run(b, {{"lods", "0.3"}});
  CHECK(pointers_of(out.json) == std::vector<std::string>{"/nodes/0/translation"});
  CHECK_FALSE(out.json["nodes"][0].contains("mesh"));
  REQUIRE(out.json["nodes"][0]["children"].size() == 1);
  const auto holder = out.json["nodes"][0]["children"][0].get<std::size_t>();
  CHECK(out.json["nodes"][holder]["extensions"].contains("MSFT_lod"));
}

TEST_CASE("an animated texture transform that is baked away is named in the report, one with its default too") {
  for (const bool is_written : {true, false}) {
    GltfBuilder b = ball();
    const auto texture = add_texture(b, flat_png(9, 99, 9), "image/png");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = texture;
    b.json["extensionsUsed"] = {"KHR_texture_transform"};
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] =
        is_written ? Json{{"offset", {0, 0}}} : Json{{"rotation", 0.5}};
    const std::string pointer =
        "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset";
    animate(b, Json::array({channel(pointer)}));
    const Run out = run(b);
    CHECK(pointers_of(out.json).empty());
    REQUIRE(out.notes("animation-dropped") == 1);
    CHECK(std::ranges::count(out.result.report.notes, pointer, &Note::where) == 1);
  }
}
