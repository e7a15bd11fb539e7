// Base colour in, atlas out: which texture is read, and which materials are changed.
#include <doctest/doctest.h>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::GltfBuilder;
using Json = nlohmann::ordered_json;

namespace {

Asset read(const test::Bytes& bytes, const Attachments& attachments = {}) {
  return read_asset(bytes, attachments, Limits{});
}

Json json_of(const Bytes& glb) {
  const auto text = split_glb(glb).json;
  return Json::parse(reinterpret_cast<const char*>(text.data()),
                     reinterpret_cast<const char*>(text.data()) + text.size());
}

test::Bytes marked(std::string_view head, std::uint8_t mark) {
  test::Bytes bytes = test::bytes_of(head);
  bytes.push_back(static_cast<std::byte>(mark));
  bytes.resize(16);
  return bytes;
}

constexpr std::string_view jpeg_head = "\xff\xd8\xff";

// A textured tetrahedron: texture 0 shows image 0, on TEXCOORD_0; TEXCOORD_1 is there as well.
GltfBuilder textured() {
  GltfBuilder b = test::tetrahedron();
  const std::vector<float> uv{0, 0, 1, 0, 0, 1, 1, 1};
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = b.add_accessor(uv, "VEC2", 2);
  primitive["attributes"]["TEXCOORD_1"] = b.add_accessor(uv, "VEC2", 2);
  primitive["material"] = 0;
  b.append("images", Json{{"bufferView", b.add_view(test::tiny_png())}, {"mimeType", "image/png"}});
  b.append("samplers", Json{{"wrapS", 33071}, {"wrapT", 33648}});
  b.append("textures", Json{{"source", 0}, {"sampler", 0}});
  b.append("materials",
           Json{{"name", "paint"},
                {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"roughnessFactor", 0.25}}}});
  return b;
}

Json& info_of(GltfBuilder& b) { return b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]; }

// A texture with its image's bytes, which outlive the asset.
struct Texture : MaterialTexture {
  test::Bytes bytes;
};

std::optional<Texture> texture_of(const GltfBuilder& b, TextureSlot slot, const Attachments& attachments = {}) {
  const Asset asset = read(b.glb(), attachments);
  const auto found = material_texture(asset, asset.primitives.at(0), slot);
  if (!found) return std::nullopt;
  return Texture{*found, {found->image.begin(), found->image.end()}};
}

std::optional<Texture> base_color_of(const GltfBuilder& b, const Attachments& attachments = {}) {
  return texture_of(b, TextureSlot::base_color, attachments);
}

Bytes write(const Asset& asset, std::vector<std::uint32_t> texcoords = {},
            const std::map<TextureSlot, std::uint32_t>& textures = {{TextureSlot::base_color, 0}}, bool plain = false) {
  std::vector<NewPrimitive> primitives;
  for (const Primitive& p : asset.primitives) {
    const std::uint32_t n = texcoords.empty() ? 2 : texcoords.at(primitives.size());
    primitives.push_back({p.indices, p.attributes, {}, n, textures, plain});
    for (const std::uint32_t set : {0u, 1u, 2u}) {
      const std::string name = "TEXCOORD_" + std::to_string(set);
      if (!p.find(name))
        primitives.back().attributes.push_back({name, ComponentType::f32, false, 2, test::Bytes(p.vertex_count() * 8)});
    }
  }
  return write_asset(asset, primitives, std::vector{NewImage{test::tiny_png(), "image/png"}}, "{}", Compression::none);
}

const Json& material_of(const Json& json, std::size_t primitive) {
  return json["materials"][json["meshes"][0]["primitives"][primitive]["material"].get<std::size_t>()];
}

} // namespace

TEST_CASE("the base colour is found with its coordinates, wrapping and transform") {
  GltfBuilder b = textured();
  auto color = base_color_of(b);
  REQUIRE(color);
  CHECK(color->bytes == test::tiny_png());
  CHECK(color->uv == "TEXCOORD_0");
  CHECK(color->wrap_s == 33071);
  CHECK(color->wrap_t == 33648);
  CHECK(color->transform[0] == 1.0f);

  info_of(b)["texCoord"] = 1;
  b.json["textures"][0].erase("sampler");
  color = base_color_of(b);
  REQUIRE(color);
  CHECK(color->uv == "TEXCOORD_1");
  CHECK(color->wrap_s == 10497);
}

TEST_CASE("a texture transform scales, then turns counter-clockwise with v pointing down, then moves") {
  GltfBuilder b = textured();
  info_of(b)["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.25, 0.5}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}, {"texCoord", 1}};
  const auto color = base_color_of(b);
  REQUIRE(color);
  CHECK(color->uv == "TEXCOORD_1");
  // (u, v) = (1, 0): scaled (2, 0), turned towards the top of the image (0, -2), moved.
  const auto& m = color->transform;
  CHECK(m[0] + m[2] == doctest::Approx(0.25));
  CHECK(m[3] + m[5] == doctest::Approx(0.5 - 2));
  // (0, 1): scaled (0, 3), turned (3, 0), moved.
  CHECK(m[1] + m[2] == doctest::Approx(0.25 + 3));
  CHECK(m[4] + m[5] == doctest::Approx(0.5));
}

TEST_CASE("there is no base colour without a texture, an image, or the coordinates") {
  const auto none_after = [](const std::function<void(GltfBuilder&)>& change) {
    GltfBuilder b = textured();
    change(b);
    return !base_color_of(b);
  };
  CHECK(none_after([](auto& b) { b.json["meshes"][0]["primitives"][0].erase("material"); }));
  CHECK(none_after([](auto& b) { b.json["materials"][0].erase("pbrMetallicRoughness"); }));
  CHECK(none_after([](auto& b) { b.json["textures"][0].erase("source"); }));
  CHECK(none_after([](auto& b) { info_of(b)["texCoord"] = 2; }));
  CHECK(none_after([](auto& b) { b.json["images"][0] = Json{{"uri", "not-here.png"}}; }));
  CHECK(none_after(
      [](auto& b) { b.json["images"][0]["bufferView"] = b.add_view(marked("\xabKTX 20\xbb\r\n\x1a\n", 0)); }));
}

TEST_CASE("an image comes from a view, a data URI or a file of the request; WebP is preferred where there is one") {
  GltfBuilder b = textured();
  b.json["images"][0] = Json{{"uri", "data:image/png;base64," + test::base64(test::tiny_png())}};
  REQUIRE(base_color_of(b));
  CHECK(base_color_of(b)->bytes == test::tiny_png());

  b.json["images"][0] = Json{{"uri", "textures/a%20b.jpg"}};
  const Attachments files{{"a b.jpg", marked(jpeg_head, 1)}};
  REQUIRE(base_color_of(b, files));
  CHECK(base_color_of(b, files)->bytes == files.at("a b.jpg"));

  const auto webp = marked("RIFF....WEBP", 2);
  b.append("images", Json{{"bufferView", b.add_view(webp)}, {"mimeType", "image/webp"}});
  b.json["textures"][0]["extensions"]["EXT_texture_webp"] = {{"source", 1}};
  CHECK(base_color_of(b, files)->bytes == webp);
}

TEST_CASE("the atlas takes the place of the base colour, and the old image goes when nothing else shows it") {
  GltfBuilder b = textured();
  info_of(b)["extensions"]["KHR_texture_transform"] = {{"scale", {2, 2}}};
  b.json["extensionsUsed"] = {"KHR_texture_transform"};
  const Json json = json_of(write(read(b.glb())));
  CHECK(json["materials"].size() == 1);
  CHECK(json["textures"].size() == 1);
  CHECK(json["images"].size() == 1);
  CHECK(json["samplers"].size() == 1);
  CHECK(json["images"][0]["name"] == "atlas");
  CHECK(json["samplers"][0]["wrapS"] == 33071);
  const Json& pbr = json["materials"][0]["pbrMetallicRoughness"];
  CHECK(pbr["baseColorTexture"] == Json{{"index", 0}, {"texCoord", 2}});
  CHECK(pbr["roughnessFactor"] == 0.25);
  CHECK(json["materials"][0]["name"] == "paint");
  CHECK_FALSE(json.contains("extensionsUsed"));
}

TEST_CASE("other textures keep their image, coordinates and transform") {
  GltfBuilder b = textured();
  b.json["extensionsUsed"] = {"KHR_texture_transform", "KHR_materials_clearcoat"};
  Json& material = b.json["materials"][0];
  material["emissiveTexture"] = {
      {"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}};
  b.append("textures", Json{{"source", 0}});
  material["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatTexture", {{"index", 1}}}};
  const Json json = json_of(write(read(b.glb())));
  CHECK(json["materials"][0]["emissiveTexture"] == material["emissiveTexture"]);
  CHECK(json["materials"][0]["extensions"] == material["extensions"]);
  CHECK(json["textures"].size() == 3);
  CHECK(json["images"].size() == 2);
  CHECK(json["extensionsUsed"] == b.json["extensionsUsed"]);
}

TEST_CASE("every slot of a material is found, and taken over where a new image is given for it") {
  GltfBuilder b = textured();
  Json& material = b.json["materials"][0];
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}, {"texCoord", 1}};
  material["occlusionTexture"] = {{"index", 0}, {"strength", 0.5}};
  material["emissiveTexture"] = {{"index", 0}};
  material["normalTexture"] = {{"index", 0}, {"scale", 0.25}};
  CHECK(texture_of(b, TextureSlot::metallic_roughness)->uv == "TEXCOORD_1");
  CHECK(texture_of(b, TextureSlot::occlusion)->uv == "TEXCOORD_0");
  CHECK(texture_of(b, TextureSlot::emissive)->bytes == test::tiny_png());
  CHECK(texture_of(b, TextureSlot::normal)->scale == 0.25f);

  const std::map<TextureSlot, std::uint32_t> two{{TextureSlot::occlusion, 0}, {TextureSlot::normal, 0}};
  const Json after = json_of(write(read(b.glb()), {}, two))["materials"][0];
  const Json& taken = after["normalTexture"];
  CHECK(taken["texCoord"] == 2);
  CHECK_FALSE(taken.contains("scale")); // it is in the image
  CHECK(after["occlusionTexture"] == Json{{"index", taken["index"]}, {"strength", 0.5}, {"texCoord", 2}});
  CHECK(taken["index"] != after["emissiveTexture"]["index"]);
  CHECK(after["emissiveTexture"] == material["emissiveTexture"]);
  CHECK(after["pbrMetallicRoughness"] == material["pbrMetallicRoughness"]);
}

TEST_CASE("a picture that must show as it is takes the base colour factor away, the model's own texture keeps it") {
  GltfBuilder b = textured();
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 1};
  const std::map<TextureSlot, std::uint32_t> color{{TextureSlot::base_color, 0}};
  CHECK(json_of(write(read(b.glb()), {}, color))["materials"][0]["pbrMetallicRoughness"].contains("baseColorFactor"));
  CHECK_FALSE(json_of(write(read(b.glb()), {}, color, true))["materials"][0]["pbrMetallicRoughness"].contains(
      "baseColorFactor"));
}

TEST_CASE("a WebP image is declared as the extension that it needs") {
  GltfBuilder b = textured();
  const Asset asset = read(b.glb());
  NewPrimitive p{asset.primitives[0].indices, asset.primitives[0].attributes, {}, 0, {{TextureSlot::base_color, 0}}};
  const std::vector<NewImage> images{{marked("RIFF....WEBP", 2), "image/webp", "base_color"}};
  const Json json = json_of(write_asset(asset, std::vector{p}, images, "{}", Compression::none));
  CHECK(json["extensionsRequired"] == Json{"EXT_texture_webp"});
  CHECK_FALSE(json["textures"][0].contains("source"));
  CHECK(json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] == 0);
  CHECK(json["images"][0]["name"] == "base_color");
}

TEST_CASE("who else looks through a primitive's tangents is found") {
  GltfBuilder b = textured();
  const auto shared = [&] {
    const Asset asset = read(b.glb());
    return shares_tangents(asset, asset.primitives[0]);
  };
  CHECK_FALSE(shared());
  b.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
  Json& extensions = b.json["materials"][0]["extensions"];
  extensions["KHR_materials_clearcoat"] = {{"clearcoatTexture", {{"index", 0}}}};
  CHECK_FALSE(shared());
  extensions["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = {{"index", 0}};
  CHECK(shared());
}

TEST_CASE("a material that points or other coordinates use too is cloned, not changed") {
  GltfBuilder b = textured();
  Json& primitives = b.json["meshes"][0]["primitives"];
  const Json original = b.json["materials"][0];

  primitives.push_back(primitives[0]);
  Json json = json_of(write(read(b.glb()), {2, 2}));
  CHECK(json["materials"].size() == 1); // both show the atlas alike

  json = json_of(write(read(b.glb()), {2, 1}));
  CHECK(json["materials"].size() == 3);
  CHECK(material_of(json, 0)["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] == 2);
  CHECK(material_of(json, 1)["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] == 1);

  primitives[1]["mode"] = 0;
  json = json_of(write(read(b.glb())));
  REQUIRE(json["materials"].size() == 2);
  CHECK(json["meshes"][0]["primitives"][1]["material"] == 0);
  CHECK(json["materials"][0] == original);
  CHECK(material_of(json, 0)["name"] == "paint");
  CHECK(material_of(json, 0)["pbrMetallicRoughness"]["baseColorTexture"]["index"] == 1);
  CHECK(json["images"].size() == 2);
}

TEST_CASE("a primitive without a material gets one that is named after its mesh") {
  GltfBuilder b = test::tetrahedron();
  b.json["meshes"][0]["name"] = "statue";
  const Json json = json_of(write(read(b.glb()), {0}));
  REQUIRE(json["materials"].size() == 1);
  CHECK(json["materials"][0]["name"] == "statue");
  CHECK(json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] == 0);
  CHECK(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] == Json{{"index", 0}});
}

TEST_CASE("variants that name the primitive's own material follow it, others keep theirs") {
  GltfBuilder b = textured();
  b.json["extensionsUsed"] = {"KHR_materials_variants"};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = Json::array({Json{{"name", "a"}}, Json{{"name", "b"}}});
  b.append("materials", b.json["materials"][0]);
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
      Json::array({Json{{"material", 0}, {"variants", {0}}}, Json{{"material", 1}, {"variants", {1}}}});
  const Json json = json_of(write(read(b.glb())));
  const Json& primitive = json["meshes"][0]["primitives"][0];
  const Json& mappings = primitive["extensions"]["KHR_materials_variants"]["mappings"];
  CHECK(mappings[0]["material"] == primitive["material"]);
  CHECK(mappings[1]["material"] == 1);
  CHECK(json["materials"][1] == b.json["materials"][1]);
}

TEST_CASE("images of data URIs and of files move into the GLB; those that did not come keep their URI") {
  GltfBuilder b = textured();
  for (const auto* uri : {"here.jpg", "https://example.com/elsewhere.png"}) {
    const auto image = b.append("images", Json{{"uri", uri}, {"name", uri}});
    const auto texture = b.append("textures", Json{{"source", image}});
    b.append("materials", Json{{"emissiveTexture", {{"index", texture}}}});
  }
  const auto embedded = b.append("images", Json{{"uri", "data:image/png;base64," + test::base64(test::tiny_png())}});
  b.append("materials", Json{{"emissiveTexture", {{"index", b.append("textures", Json{{"source", embedded}})}}}});
  const Json json = json_of(write(read(b.glb(), {{"here.jpg", marked(jpeg_head, 1)}})));
  REQUIRE(json["images"].size() == 4);
  CHECK(json["images"][0]["name"] == "here.jpg");
  CHECK(json["images"][0]["mimeType"] == "image/jpeg");
  CHECK_FALSE(json["images"][0].contains("uri"));
  CHECK(json["images"][1]["uri"] == "https://example.com/elsewhere.png");
  CHECK(json["images"][2]["mimeType"] == "image/png");
  CHECK_FALSE(json["images"][2].contains("uri"));
}

TEST_CASE("animations of the texture transform that the atlas took away go, others stay") {
  GltfBuilder b = textured();
  info_of(b)["extensions"]["KHR_texture_transform"] = {{"offset", {0, 0}}};
  const auto time = b.add_accessor(std::vector<float>{0, 1}, "SCALAR", 1);
  const auto values = b.add_accessor(std::vector<float>{0, 0, 1, 1}, "VEC2", 2);
  const auto channel = [](const char* pointer) {
    return Json{{"sampler", 0},
                {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
  };
  const Json samplers = Json::array({Json{{"input", time}, {"output", values}}});
  const Json dead =
      channel("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset");
  const Json alive = channel("/materials/0/pbrMetallicRoughness/roughnessFactor");
  b.append("animations", Json{{"name", "both"}, {"channels", Json::array({dead, alive})}, {"samplers", samplers}});
  b.append("animations", Json{{"name", "dead"}, {"channels", Json::array({dead})}, {"samplers", samplers}});
  const Json json = json_of(write(read(b.glb())));
  REQUIRE(json["animations"].size() == 1);
  CHECK(json["animations"][0]["channels"] == Json::array({alive}));
}
