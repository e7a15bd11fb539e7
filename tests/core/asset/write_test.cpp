// What write_asset delivers: the new geometry to the bit, and everything else as it came.
#include <doctest/doctest.h>

#include <algorithm>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;
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

test::Bytes view_bytes(const Bytes& glb, const Json& json, std::size_t view) {
  const Json& v = json["bufferViews"][view];
  const auto part = split_glb(glb).bin->subspan(v["byteOffset"].get<std::size_t>(), v["byteLength"].get<std::size_t>());
  return {part.begin(), part.end()};
}

// The primitive as it is, with atlas coordinates and sphere points added.
NewPrimitive with_atlas(const Primitive& primitive) {
  NewPrimitive out{primitive.indices, primitive.attributes, primitive.targets, 0, {}, false};
  while (primitive.find("TEXCOORD_" + std::to_string(out.atlas_texcoord))) ++out.atlas_texcoord;
  Attribute uv{"TEXCOORD_" + std::to_string(out.atlas_texcoord), ComponentType::f32, false, 2,
               test::Bytes(primitive.vertex_count() * 8)};
  Attribute sphere{"_SPHERE", ComponentType::f32, false, 3, test::Bytes(primitive.vertex_count() * 12)};
  for (std::size_t v = 0; v < primitive.vertex_count(); ++v) {
    uv.set(v, 0, 0.1 * static_cast<double>(v % 10));
    sphere.set(v, static_cast<std::uint32_t>(v % 3), v % 2 == 0 ? 1.0 : -1.0);
  }
  out.attributes.push_back(uv);
  out.attributes.push_back(sphere);
  out.textures[TextureSlot::base_color] = 0;
  return out;
}

std::vector<NewPrimitive> with_atlas(const Asset& asset) {
  std::vector<NewPrimitive> out;
  for (const Primitive& primitive : asset.primitives) out.push_back(with_atlas(primitive));
  return out;
}

const std::vector<NewImage> atlas{{test::tiny_png(), "image/png"}};

Bytes write(const Asset& asset, Compression compression = Compression::none) {
  return write_asset(asset, with_atlas(asset), atlas, R"({"version":"1"})", compression);
}
Bytes write(const GltfBuilder& b, Compression compression = Compression::none) {
  return write(read(b.glb()), compression);
}

// Each triangle with its smallest index first: meshopt does not keep the corner that it begins with.
std::vector<std::uint32_t> from_smallest(std::vector<std::uint32_t> indices) {
  for (auto t = indices.begin(); t != indices.end(); t += 3) std::rotate(t, std::min_element(t, t + 3), t + 3);
  return indices;
}

void check_same(const Asset& delivered, std::span<const NewPrimitive> wanted) {
  REQUIRE(delivered.primitives.size() == wanted.size());
  const auto check_attributes = [](const std::vector<Attribute>& a, const std::vector<Attribute>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      CAPTURE(b[i].name);
      CHECK(a[i].name == b[i].name);
      CHECK(a[i].type == b[i].type);
      CHECK(a[i].normalized == b[i].normalized);
      CHECK(a[i].components == b[i].components);
      CHECK(a[i].data == b[i].data);
    }
  };
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    CHECK(from_smallest(delivered.primitives[i].indices) == from_smallest(wanted[i].indices));
    check_attributes(delivered.primitives[i].attributes, wanted[i].attributes);
    REQUIRE(delivered.primitives[i].targets.size() == wanted[i].targets.size());
    for (std::size_t t = 0; t < wanted[i].targets.size(); ++t) {
      check_attributes(delivered.primitives[i].targets[t], wanted[i].targets[t]);
    }
  }
}

// A tetrahedron with attributes of every kind and size, and two morph targets.
GltfBuilder rich() {
  GltfBuilder b = test::tetrahedron();
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  Json& attributes = primitive["attributes"];
  attributes["NORMAL"] = b.add_accessor(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1}, "VEC3", 3);
  attributes["TEXCOORD_0"] = b.add_accessor(std::vector<std::uint16_t>{0, 65535, 1, 2, 3, 4, 5, 6}, "VEC2", 2, true);
  attributes["COLOR_0"] =
      b.add_accessor(std::vector<std::uint8_t>{255, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14}, "VEC4", 4, true);
  attributes["_BYTES"] = b.add_accessor(std::vector<std::int8_t>{-128, 5, 0, 127}, "SCALAR", 1);
  attributes["_ODD"] = b.add_accessor(std::vector<std::uint16_t>{1, 2, 65535, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "VEC3", 3);
  attributes["_NUMBERS"] = b.add_accessor(std::vector<float>{-0.0f, 1e-45f, 3.4e38f, 0.1f}, "SCALAR", 1);
  const auto delta = b.add_accessor(std::vector<float>{0.5f, 0, 0, 0, 0.25f, 0, 0, 0, 0, -1, 0, 0}, "VEC3", 3);
  primitive["targets"] = Json::array({Json{{"POSITION", delta}}, Json{{"POSITION", delta}, {"NORMAL", delta}}});
  b.json["meshes"][0]["weights"] = {0.5, 0};
  return b;
}

} // namespace

TEST_CASE("what is written reads back to the bit, plain and compressed") {
  const Asset asset = read(rich().glb());
  const auto wanted = with_atlas(asset);
  for (const Compression compression : {Compression::none, Compression::draco, Compression::meshopt}) {
    CAPTURE(static_cast<int>(compression));
    check_same(read(write(asset, compression)), wanted);
  }
}

TEST_CASE("the same input gives the same bytes") {
  for (const Compression compression : {Compression::none, Compression::draco, Compression::meshopt}) {
    CHECK(write(rich(), compression) == write(rich(), compression));
  }
}

TEST_CASE("vertex attributes are aligned, strided and have targets; positions have exact bounds") {
  const Bytes glb = write(rich());
  const Json json = json_of(glb);
  const Json& primitive = json["meshes"][0]["primitives"][0];
  for (const auto& [name, number] : primitive["attributes"].items()) {
    CAPTURE(name);
    const Json& view =
        json["bufferViews"][json["accessors"][number.get<std::size_t>()]["bufferView"].get<std::size_t>()];
    CHECK(view["target"] == 34962);
    CHECK(view["byteStride"].get<std::size_t>() % 4 == 0);
    CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
  }
  const Json& indices = json["accessors"][primitive["indices"].get<std::size_t>()];
  CHECK(indices["componentType"] == 5123);
  CHECK(json["bufferViews"][indices["bufferView"].get<std::size_t>()]["target"] == 34963);
  const Json& position = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  CHECK(position["min"] == Json{-1.0, -1.0, -1.0});
  CHECK(position["max"] == Json{1.0, 1.0, 1.0});
  const Json& target = json["accessors"][primitive["targets"][0]["POSITION"].get<std::size_t>()];
  CHECK(target["min"] == Json{-1.0, 0.0, 0.0});
  CHECK(target["max"] == Json{0.5, 0.25, 0.0});
}

TEST_CASE("indices take 32 bits only where they must") {
  for (const std::size_t vertices : {65535u, 65536u}) {
    GltfBuilder b;
    std::vector<float> positions(vertices * 3);
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i % 97);
    b.add_mesh(
        Json{{"attributes", {{"POSITION", b.add_accessor(positions, "VEC3", 3)}}},
             {"indices", b.add_accessor(std::vector<std::uint32_t>{0, 1, static_cast<std::uint32_t>(vertices - 1)},
                                        "SCALAR", 1)}});
    const Bytes glb = write(b);
    const Json json = json_of(glb);
    const Json& indices = json["accessors"][json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()];
    CHECK(indices["componentType"] == (vertices == 65535 ? 5123 : 5125));
    CHECK(read(glb).primitives.at(0).indices.back() == vertices - 1);
  }
}

TEST_CASE("everything that is not geometry survives: names, extras, unknown extensions, animations, key order") {
  GltfBuilder b = rich();
  b.json["extensionsUsed"] = {"ACME_unknown"};
  b.json["asset"]["generator"] = "the input's";
  b.json["asset"]["copyright"] = "© someone";
  b.json["asset"]["extras"] = {{"mine", 1}};
  b.json["meshes"][0]["name"] = "mesh";
  b.json["meshes"][0]["extras"] = {{"targetNames", {"a", "b"}}};
  b.json["meshes"][0]["primitives"][0]["extras"] = {{"kept", true}};
  b.json["nodes"][0]["name"] = "node";
  b.json["nodes"][0]["translation"] = {0.1, 1e-7, 12345678.9};
  b.json["nodes"][0]["extensions"]["ACME_unknown"] = {{"z", nullptr}, {"a", {1, 2.5, "x"}}};
  b.append("cameras", Json{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}});
  const auto time = b.add_accessor(std::vector<float>{0, 1}, "SCALAR", 1);
  const auto moves = b.add_accessor(std::vector<float>{0, 0, 0, 1, 2, 3}, "VEC3", 3);
  b.append("animations",
           Json{{"name", "walk"},
                {"channels", Json::array({Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})},
                {"samplers", Json::array({Json{{"input", time}, {"output", moves}}})}});
  const Bytes glb = write(b);
  const Json json = json_of(glb);
  CHECK(json["asset"]["generator"] == "the input's");
  CHECK(json["asset"]["copyright"] == "© someone");
  CHECK(json["asset"]["extras"]["mine"] == 1);
  CHECK(json["asset"]["extras"]["orbis"]["version"] == "1");
  CHECK(json["nodes"].dump() == b.json["nodes"].dump());
  CHECK(json["cameras"].dump() == b.json["cameras"].dump());
  CHECK(json["scenes"].dump() == b.json["scenes"].dump());
  CHECK(json["meshes"][0]["name"] == "mesh");
  CHECK(json["meshes"][0]["extras"] == b.json["meshes"][0]["extras"]);
  CHECK(json["meshes"][0]["weights"] == b.json["meshes"][0]["weights"]);
  CHECK(json["meshes"][0]["primitives"][0]["extras"]["kept"] == true);
  CHECK(json["extensionsUsed"] == b.json["extensionsUsed"]);
  const auto output = json["animations"][0]["samplers"][0]["output"].get<std::size_t>();
  CHECK(view_bytes(glb, json, json["accessors"][output]["bufferView"].get<std::size_t>()) ==
        bytes_of({0.f, 0.f, 0.f, 1.f, 2.f, 3.f}));
  // An extension that is not understood may count accessors: none moved.
  CHECK(output == moves);
}

TEST_CASE("the buffer holds only what is still referenced") {
  GltfBuilder b = test::tetrahedron();
  const auto time = b.add_accessor(std::vector<float>{0, 1}, "SCALAR", 1);
  const auto moves = b.add_accessor(std::vector<float>{0, 0, 0, 1, 2, 3}, "VEC3", 3);
  b.append("animations",
           Json{{"channels", Json::array({Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})},
                {"samplers", Json::array({Json{{"input", time}, {"output", moves}}})}});
  const Bytes glb = write(b);
  const Json json = json_of(glb);
  CHECK(json["accessors"].size() == 2 + 3 + 1); // the animation's, POSITION, TEXCOORD_0, _SPHERE, the indices
  CHECK(json["bufferViews"].size() == 6 + 1);   // and the atlas
  CHECK(json["buffers"].size() == 1);
  std::size_t used = 0;
  for (const Json& view : json["bufferViews"]) used += (view["byteLength"].get<std::size_t>() + 3) / 4 * 4;
  CHECK(split_glb(glb).bin->size() == used);
}

TEST_CASE("extras of the input that are no object are kept beside ours") {
  GltfBuilder b = test::tetrahedron();
  b.json["asset"]["extras"] = "a string";
  const Json json = json_of(write(b));
  CHECK(json["asset"]["extras"]["input"] == "a string");
  CHECK(json["asset"]["extras"]["orbis"]["version"] == "1");
}

TEST_CASE("strips become lists, and points beside them stay as they were") {
  GltfBuilder b = test::tetrahedron();
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives[0]["mode"] = 5;
  primitives.push_back(Json{{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  const Bytes glb = write(b);
  const Json json = json_of(glb);
  CHECK_FALSE(json["meshes"][0]["primitives"][0].contains("mode"));
  const Json& points = json["meshes"][0]["primitives"][1];
  CHECK(points["mode"] == 0);
  const Json& accessor = json["accessors"][points["attributes"]["POSITION"].get<std::size_t>()];
  CHECK(view_bytes(glb, json, accessor["bufferView"].get<std::size_t>()) ==
        bytes_of(std::span<const float>(test::tetrahedron_positions)));
}

TEST_CASE("compressed output says so, and names quantised attributes") {
  GltfBuilder b = test::tetrahedron();
  const auto view = b.add_view(bytes_of(std::vector<std::int16_t>(16, 5).size() == 16
                                            ? std::span<const std::int16_t>(std::vector<std::int16_t>{
                                                  1, 1, 1, 0, -1, -1, 1, 0, -1, 1, -1, 0, 1, -1, -1, 0})
                                            : std::span<const std::int16_t>()),
                               8);
  b.json["accessors"][0] = Json{{"bufferView", view}, {"componentType", 5122}, {"count", 4}, {"type", "VEC3"}};
  const Asset asset = read(b.glb());
  const Bytes glb = write(asset, Compression::draco);
  const Json json = json_of(glb);
  CHECK(json["extensionsUsed"] == Json{"KHR_draco_mesh_compression", "KHR_mesh_quantization"});
  CHECK(json["extensionsRequired"] == json["extensionsUsed"]);
  const Json& primitive = json["meshes"][0]["primitives"][0];
  CHECK(primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"].size() == 3);
  const Json& position = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  CHECK_FALSE(position.contains("bufferView"));
  CHECK(position["min"] == Json{-1.0, -1.0, -1.0});
  check_same(read(glb), with_atlas(asset));

  // Read back and written plain, the result needs Draco no more.
  const Json plain = json_of(write_asset(read(glb), std::vector{with_atlas(asset)[0]}, atlas, "{}", Compression::none));
  CHECK(plain["extensionsRequired"] == Json{"KHR_mesh_quantization"});
  CHECK(plain["extensionsUsed"] == Json{"KHR_mesh_quantization"});
}

TEST_CASE("meshopt views name their bytes in the first buffer and stand for a second one that holds none") {
  const Bytes glb = write(rich(), Compression::meshopt);
  const Json json = json_of(glb);
  CHECK(json["extensionsRequired"] == Json{"EXT_meshopt_compression"});
  REQUIRE(json["buffers"].size() == 2);
  CHECK(json["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"] == true);
  std::size_t end = 0, compressed = 0;
  for (const Json& view : json["bufferViews"]) {
    if (!view.contains("extensions")) continue;
    const Json& stored = view["extensions"]["EXT_meshopt_compression"];
    CHECK(view["buffer"] == 1);
    CHECK(view["byteOffset"].get<std::size_t>() >= end);
    CHECK(view["byteLength"] == stored["count"].get<std::size_t>() * stored["byteStride"].get<std::size_t>());
    end = view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>();
    CHECK(end <= json["buffers"][1]["byteLength"].get<std::size_t>());
    CHECK(stored["byteOffset"].get<std::size_t>() + stored["byteLength"].get<std::size_t>() <=
          json["buffers"][0]["byteLength"].get<std::size_t>());
    ++compressed;
  }
  CHECK(compressed > 6);
  // Read back and written plain, the result needs the extension no more.
  const Asset again = read(glb);
  CHECK_FALSE(json_of(write_asset(again, std::vector{with_atlas(again)[0]}, atlas, "{}", Compression::none))
                  .contains("extensionsRequired"));
}

TEST_CASE("quantised normals and tangents are 16-bit integers that point the same way") {
  GltfBuilder b = test::tetrahedron();
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] =
      b.add_accessor(std::vector<float>{0.6f, 0, 0.8f, 0, 1, 0, -0.36f, 0.48f, 0.8f, 0, 0, -1}, "VEC3", 3);
  attributes["TANGENT"] =
      b.add_accessor(std::vector<float>{0, 1, 0, 1, 1, 0, 0, -1, 0.8f, 0.6f, 0, 1, 0, -1, 0, -1}, "VEC4", 4);
  const Asset asset = read(b.glb());
  std::vector<NewPrimitive> primitives = with_atlas(asset);
  for (NewPrimitive& p : primitives) quantise_directions(p);
  const Bytes glb = write_asset(asset, primitives, atlas, "{}", Compression::quantized);
  CHECK(json_of(glb)["extensionsRequired"] == Json{"EXT_meshopt_compression", "KHR_mesh_quantization"});
  const Asset delivered = read(glb);
  for (const char* name : {"NORMAL", "TANGENT"}) {
    const Attribute &before = *asset.primitives[0].find(name), &after = *delivered.primitives[0].find(name);
    CHECK(after.type == ComponentType::i16);
    CHECK(after.normalized);
    for (std::size_t v = 0; v < before.count(); ++v)
      for (std::uint32_t c = 0; c < before.components; ++c)
        CHECK(after.get(v, c) == doctest::Approx(before.get(v, c)).epsilon(2e-5));
  }
  CHECK(delivered.primitives[0].find("POSITION")->data == asset.primitives[0].find("POSITION")->data);
}

TEST_CASE("a primitive that is not replaced stays as it was, whatever its compression") {
  GltfBuilder b = test::tetrahedron();
  b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  const Asset compressed = read(write(b, Compression::draco));
  std::vector<NewPrimitive> wanted = with_atlas(compressed);
  for (NewPrimitive& p : wanted) p.atlas_texcoord = 0;
  wanted[1].indices.clear();
  const Asset delivered = read(write_asset(compressed, wanted, atlas, "{}", Compression::none));
  REQUIRE(delivered.primitives.size() == 2);
  for (const Primitive& p : delivered.primitives) CHECK(p.indices == compressed.primitives[0].indices);
  CHECK(delivered.primitives[1].attributes.size() == compressed.primitives[1].attributes.size());
}

TEST_CASE("new primitives that do not fit together are refused") {
  const Asset asset = read(test::tetrahedron().glb());
  const auto refused = [&](auto damage) {
    std::vector<NewPrimitive> primitives = with_atlas(asset);
    damage(primitives[0]);
    CHECK_THROWS_AS((void)write_asset(asset, primitives, atlas, "{}", Compression::none), Error);
  };
  refused([](NewPrimitive& p) { p.indices[0] = 4; });
  refused([](NewPrimitive& p) { p.indices.pop_back(); });
  refused([](NewPrimitive& p) { p.textures[TextureSlot::normal] = 1; });
  refused([](NewPrimitive& p) { p.attributes.pop_back(), p.attributes.pop_back(); });
  refused([](NewPrimitive& p) { p.attributes[0].data.resize(36); });
  refused([](NewPrimitive& p) { p.targets.push_back({p.attributes[0]}), p.targets[0][0].data.resize(36); });
  CHECK_THROWS_AS((void)write_asset(asset, {}, atlas, "{}", Compression::none), Error);
  CHECK_THROWS_AS((void)write_asset(asset, with_atlas(asset), atlas, "[]", Compression::none), Error);
}

TEST_CASE("what Draco cannot hold is written plain") {
  GltfBuilder wide = test::tetrahedron();
  wide.json["meshes"][0]["primitives"][0]["attributes"]["_A"] =
      wide.add_accessor(std::vector<std::uint32_t>{0, 4294967295u, 2147483648u, 7}, "SCALAR", 1);
  GltfBuilder sparse = test::tetrahedron(); // more vertices than corners
  std::vector<float> positions(60, 0.5f);
  sparse.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = sparse.add_accessor(positions, "VEC3", 3);
  for (const GltfBuilder& b : {wide, sparse}) {
    const Asset asset = read(b.glb());
    const Bytes glb = write(asset, Compression::draco);
    CHECK_FALSE(json_of(glb).contains("extensionsRequired"));
    check_same(read(glb), with_atlas(asset));
  }
}

TEST_CASE("the extremes of every integer type survive compression") {
  GltfBuilder b = test::tetrahedron();
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["_A"] = b.add_accessor(std::vector<std::int8_t>{-128, 127, 0, -1}, "SCALAR", 1);
  attributes["_B"] =
      b.add_accessor(std::vector<std::int16_t>{-32768, 32767, 0, -1, -32768, 32767, 1, 2}, "VEC2", 2, true);
  attributes["_C"] = b.add_accessor(std::vector<std::uint8_t>{0, 255, 255, 0, 1, 2, 3, 4, 5, 6, 7, 8}, "VEC3", 3);
  attributes["_D"] = b.add_accessor(std::vector<std::uint16_t>{0, 65535, 32768, 1}, "SCALAR", 1);
  const Asset asset = read(b.glb());
  const Bytes glb = write(asset, Compression::draco);
  CHECK(json_of(glb)["extensionsRequired"] == Json{"KHR_draco_mesh_compression"});
  check_same(read(glb), with_atlas(asset));
}
