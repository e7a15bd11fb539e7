// Nodes that mirror a mesh which others do not show a copy of it, whose bitangents point the other way.
#include "core/asset/mirrored_instances.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/asset/glb.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::GltfBuilder;
using Json = nlohmann::ordered_json;

namespace {

const Json mirror{-1, 1, 1};

// A triangle with tangents of w = 1 in a mesh that no node shows.
GltfBuilder triangle() {
  GltfBuilder b;
  Json attributes;
  attributes["POSITION"] = b.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  attributes["NORMAL"] = b.add_accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  attributes["TANGENT"] = b.add_accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", 4);
  attributes["TEXCOORD_0"] = b.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  const Json target{{"POSITION", attributes["NORMAL"]}};
  Json primitive{{"attributes", attributes}, {"targets", Json::array({target})}, {"extras", {{"of", "primitive"}}}};
  b.append("meshes", Json{{"primitives", Json::array({primitive})}, {"name", "card"}, {"weights", {0.5}}});
  return b;
}

Bytes written(const GltfBuilder& b, Compression compression = Compression::none) {
  const Asset asset = read_asset(b.glb(), {}, {});
  std::vector<NewPrimitive> primitives;
  for (const Primitive& p : asset.primitives) {
    NewPrimitive& out = primitives.emplace_back();
    out.indices = p.indices;
    out.attributes = p.attributes;
    out.targets = p.targets;
    out.mirrors_tangents = true;
  }
  return write_asset(asset, primitives, {}, "{}", compression);
}

Json json_of(const Bytes& glb) {
  const auto text = split_glb(glb).json;
  return Json::parse(reinterpret_cast<const char*>(text.data()),
                     reinterpret_cast<const char*>(text.data()) + text.size());
}

std::vector<double> handedness(const Primitive& primitive) {
  const Attribute& tangent = *primitive.find("TANGENT");
  std::vector<double> out;
  for (std::size_t v = 0; v < tangent.count(); ++v) out.push_back(tangent.get(v, 3));
  return out;
}

// The mesh of each node.
std::vector<int> meshes_of(const Json& json) {
  std::vector<int> out;
  for (const Json& node : json["nodes"]) out.push_back(node.value("mesh", -1));
  return out;
}

} // namespace

TEST_CASE("the copy for nodes that mirror has tangents of its own, and shares all else") {
  GltfBuilder b = triangle();
  b.append("nodes", Json{{"mesh", 0}, {"weights", {0.25}}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", mirror}, {"weights", {0.75}}, {"name", "left"}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", {-1, -1, 1}}});
  const Json json = json_of(written(b));
  CHECK(meshes_of(json) == std::vector{0, 1, 0});
  CHECK(json["nodes"][1]["weights"] == Json{0.75});
  REQUIRE(json["meshes"].size() == 2);
  Json copy = json["meshes"][1];
  const std::size_t own = copy["primitives"][0]["attributes"]["TANGENT"];
  CHECK(own != json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"]);
  copy["primitives"][0]["attributes"]["TANGENT"] = json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"];
  CHECK(copy == json["meshes"][0]);
}

TEST_CASE("however the geometry is stored, w is negated in the copy alone") {
  GltfBuilder b = triangle();
  b.append("nodes", Json{{"mesh", 0}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", mirror}});
  for (const Compression compression : {Compression::none, Compression::draco, Compression::meshopt}) {
    CAPTURE(static_cast<int>(compression));
    const Asset delivered = read_asset(written(b, compression), {}, {});
    REQUIRE(delivered.primitives.size() == 2);
    CHECK(handedness(delivered.primitives[0]) == std::vector<double>{1, 1, 1});
    CHECK(handedness(delivered.primitives[1]) == std::vector<double>{-1, -1, -1});
    CHECK(delivered.primitives[0].find("POSITION")->data == delivered.primitives[1].find("POSITION")->data);
  }
}

TEST_CASE("what counts is the transform from the root: mirrored twice is not mirrored") {
  GltfBuilder b = triangle();
  b.append("nodes", Json{{"scale", mirror}, {"children", {1, 2}}});
  b.append("nodes", Json{{"mesh", 0}});
  b.append("nodes", Json{{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 5, 5, 5, 1}}});
  CHECK(meshes_of(json_of(written(b))) == std::vector{-1, 1, 0});
}

TEST_CASE("a level of the input stands where its node does, with a scale of its own") {
  GltfBuilder b = triangle();
  b.json["extensionsUsed"] = {"MSFT_lod"};
  b.append("nodes", Json{{"scale", mirror}, {"children", {1}}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", mirror}, {"extensions", {{"MSFT_lod", {{"ids", {2, 3}}}}}}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", mirror}});
  b.append("nodes", Json{{"mesh", 0}});
  CHECK(meshes_of(json_of(written(b))) == std::vector{-1, 0, 0, 1});
}

TEST_CASE("joints place a skinned mesh, whatever its node says") {
  GltfBuilder b = triangle();
  b.append("skins", Json{{"joints", {1}}});
  b.append("nodes", Json{{"mesh", 0}, {"skin", 0}, {"scale", mirror}});
  b.append("nodes", Json::object());
  const std::vector<Handedness> meshes = handedness_of_meshes(read_asset(b.glb(), {}, {}));
  REQUIRE(meshes.size() == 1);
  CHECK(meshes[0].straight);
  CHECK_FALSE(meshes[0].mirrored);
}

TEST_CASE("instances mirror too: all of a node's, or some, which cannot be told apart") {
  for (const float second : {-2.0F, 2.0F}) {
    GltfBuilder b = triangle();
    b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    const std::size_t scales = b.add_accessor<float>({1, 1, -1, 1, 1, second}, "VEC3", 3);
    b.append("nodes", Json{{"mesh", 0}});
    b.append("nodes",
             Json{{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", scales}}}}}}}});
    const std::vector<Handedness> meshes = handedness_of_meshes(read_asset(b.glb(), {}, {}));
    REQUIRE(meshes.size() == 1);
    CHECK(meshes[0].straight);
    CHECK(meshes[0].mirrored == (second < 0));
    CHECK(meshes[0].mixed == (second > 0));
    CHECK(meshes_of(json_of(written(b))) == std::vector{0, second < 0 ? 1 : 0});
  }
}

TEST_CASE("what animates a mesh by pointer animates its copy") {
  GltfBuilder b = triangle();
  b.append("nodes", Json{{"mesh", 0}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", mirror}});
  b.json["extensionsUsed"] = {"KHR_animation_pointer"};
  const Json pointer{{"KHR_animation_pointer", {{"pointer", "/meshes/0/weights"}}}};
  const Json channel{{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", pointer}}}};
  const Json sampler{{"input", b.add_accessor<float>({0, 1}, "SCALAR", 1)},
                     {"output", b.add_accessor<float>({0, 1}, "SCALAR", 1)}};
  b.append("animations", Json{{"channels", Json::array({channel})}, {"samplers", Json::array({sampler})}});
  const Json json = json_of(written(b));
  const Json& channels = json["animations"][0]["channels"];
  REQUIRE(channels.size() == 2);
  CHECK(channels[1]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] == "/meshes/1/weights");
}

TEST_CASE("where no node mirrors there is no copy") {
  GltfBuilder b = triangle();
  b.append("nodes", Json{{"mesh", 0}});
  b.append("nodes", Json{{"mesh", 0}, {"scale", {2, 3, 4}}});
  CHECK(json_of(written(b))["meshes"].size() == 1);
}
