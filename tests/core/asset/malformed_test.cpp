// Files that are broken in one way each: every one is refused with the right code, and nothing else happens.
#include <doctest/doctest.h>

#include <functional>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;
using test::GltfBuilder;
using Json = nlohmann::ordered_json;

namespace {

Error error_of(const test::Bytes& bytes, const Limits& limits = {}) {
  try {
    (void)read_asset(bytes, {}, limits);
  } catch (const Error& error) {
    return error;
  }
  FAIL("the file was read");
  return Error(ErrorCode::internal, "unreachable");
}

struct Case {
  const char* name;
  ErrorCode code;
  const char* where;
  std::function<void(GltfBuilder&)> damage; // of a tetrahedron: accessor 0 positions, accessor 1 indices
};

Json& primitive_of(GltfBuilder& b) { return b.json["meshes"][0]["primitives"][0]; }
Json& accessor_of(GltfBuilder& b, std::size_t i) { return b.json["accessors"][i]; }
Json& view_of(GltfBuilder& b, std::size_t i) { return b.json["bufferViews"][i]; }

constexpr auto malformed = ErrorCode::malformed;

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"no asset", malformed, "/asset", [](auto& b) { b.json.erase("asset"); }},
      {"no version", malformed, "/asset/version", [](auto& b) { b.json["asset"] = Json::object(); }},
      {"version 1.0", ErrorCode::unsupported_format, "/asset/version",
       [](auto& b) { b.json["asset"]["version"] = "1.0"; }},
      {"least version 2.1", ErrorCode::unsupported_format, "/asset/version",
       [](auto& b) { b.json["asset"]["minVersion"] = "2.1"; }},
      {"an unknown extension is required", ErrorCode::unsupported_feature, "/extensionsRequired/0",
       [](auto& b) { b.json["extensionsRequired"] = {"ACME_geometry"}; }},
      {"extensionsUsed is no array", malformed, "/extensionsUsed", [](auto& b) { b.json["extensionsUsed"] = 1; }},
      {"meshes is an object", malformed, "/meshes", [](auto& b) { b.json["meshes"] = Json::object(); }},
      {"a mesh is a number", malformed, "/meshes/0", [](auto& b) { b.json["meshes"][0] = 7; }},
      {"a mesh has no primitives", malformed, "/meshes/0/primitives",
       [](auto& b) { b.json["meshes"][0].erase("primitives"); }},
      {"no attributes", malformed, "/meshes/0/primitives/0/attributes",
       [](auto& b) { primitive_of(b).erase("attributes"); }},
      {"no positions", ErrorCode::invalid_geometry, "/meshes/0/primitives/0",
       [](auto& b) { primitive_of(b)["attributes"] = Json::object(); }},
      {"mode 7", malformed, "/meshes/0/primitives/0/mode", [](auto& b) { primitive_of(b)["mode"] = 7; }},
      {"an accessor that is not there", malformed, "/meshes/0/primitives/0/attributes/POSITION",
       [](auto& b) { primitive_of(b)["attributes"]["POSITION"] = 99; }},
      {"an accessor of number -1", malformed, "/meshes/0/primitives/0/indices",
       [](auto& b) { primitive_of(b)["indices"] = -1; }},
      {"a material that is not there", malformed, "/meshes/0/primitives/0/material",
       [](auto& b) { primitive_of(b)["material"] = 0; }},
      {"targets of numbers", malformed, "/meshes/0/primitives/0/targets",
       [](auto& b) { primitive_of(b)["targets"] = {1}; }},
      {"an unknown component type", malformed, "/accessors/0/componentType",
       [](auto& b) { accessor_of(b, 0)["componentType"] = 5124; }},
      {"no component type", malformed, "/accessors/0/componentType",
       [](auto& b) { accessor_of(b, 0).erase("componentType"); }},
      {"an unknown type", malformed, "/accessors/0/type", [](auto& b) { accessor_of(b, 0)["type"] = "VEC5"; }},
      {"count 0", malformed, "/accessors/0/count", [](auto& b) { accessor_of(b, 0)["count"] = 0; }},
      {"count -1", malformed, "/accessors/0/count", [](auto& b) { accessor_of(b, 0)["count"] = -1; }},
      {"count 4.5", malformed, "/accessors/0/count", [](auto& b) { accessor_of(b, 0)["count"] = 4.5; }},
      {"count 2^64 - 1", malformed, "/accessors/0/count",
       [](auto& b) { accessor_of(b, 0)["count"] = 18446744073709551615ull; }},
      {"count 2^32 - 1", malformed, "/accessors/0", [](auto& b) { accessor_of(b, 0)["count"] = 4294967295u; }},
      {"three billion zeros", ErrorCode::too_large, "/accessors/1/count",
       [](auto& b) {
         accessor_of(b, 1).erase("bufferView");
         accessor_of(b, 1)["count"] = 3000000000u;
       }},
      {"an offset beyond the view", malformed, "/accessors/0", [](auto& b) { accessor_of(b, 0)["byteOffset"] = 4; }},
      {"an offset that would wrap around", malformed, "/accessors/0/byteOffset",
       [](auto& b) { accessor_of(b, 0)["byteOffset"] = 18446744073709551608ull; }},
      {"an offset that is not aligned", malformed, "/accessors/1",
       [](auto& b) {
         accessor_of(b, 1)["byteOffset"] = 1;
         accessor_of(b, 1)["count"] = 9;
       }},
      {"normalized is a number", malformed, "/accessors/0/normalized",
       [](auto& b) { accessor_of(b, 0)["normalized"] = 1; }},
      {"positions of two components", malformed, "/meshes/0/primitives/0/attributes/POSITION",
       [](auto& b) { accessor_of(b, 0)["type"] = "VEC2"; }},
      {"indices of floats", malformed, "/accessors/1",
       [](auto& b) {
         accessor_of(b, 1)["componentType"] = 5126;
         accessor_of(b, 1)["count"] = 6;
       }},
      {"a view beyond the buffer", malformed, "/bufferViews/0",
       [](auto& b) { view_of(b, 0)["byteOffset"] = 2147483648u; }},
      {"a view longer than the buffer", malformed, "/bufferViews/1",
       [](auto& b) { view_of(b, 1)["byteLength"] = 1000; }},
      {"a view of no bytes", malformed, "/bufferViews/0/byteLength", [](auto& b) { view_of(b, 0)["byteLength"] = 0; }},
      {"a view of no buffer", malformed, "/bufferViews/0/buffer", [](auto& b) { view_of(b, 0).erase("buffer"); }},
      {"a view of a buffer that is not there", malformed, "/bufferViews/0/buffer",
       [](auto& b) { view_of(b, 0)["buffer"] = 1; }},
      {"a stride of 6", malformed, "/bufferViews/0/byteStride", [](auto& b) { view_of(b, 0)["byteStride"] = 6; }},
      {"a stride of 256", malformed, "/bufferViews/0/byteStride", [](auto& b) { view_of(b, 0)["byteStride"] = 256; }},
      {"a stride below the element", malformed, "/accessors/0", [](auto& b) { view_of(b, 0)["byteStride"] = 8; }},
      {"a stride that leaves the view", malformed, "/accessors/0", [](auto& b) { view_of(b, 0)["byteStride"] = 16; }},
      {"a buffer longer than its data", malformed, "/buffers/0",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", b.bin.size() + 100}}});
       }},
      {"a buffer without a length", malformed, "/buffers/0/byteLength",
       [](auto& b) { b.json["buffers"] = Json::array({Json::object()}); }},
      {"a buffer in a file", ErrorCode::missing_resource, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "../../../../etc/passwd"}}});
       }},
      {"a buffer in the current folder", ErrorCode::missing_resource, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "."}}});
       }},
      {"a buffer in the network", ErrorCode::missing_resource, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "http://127.0.0.1:1/x"}}});
       }},
      {"a data URI that is not base64", malformed, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "data:;base64,%!QAAAQAAA5"}}});
       }},
      {"a data URI without base64", malformed, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "data:,abc"}}});
       }},
      {"a data URI with too much padding", malformed, "/buffers/0/uri",
       [](auto& b) {
         b.json["buffers"] = Json::array({Json{{"byteLength", 72}, {"uri", "data:;base64,A==="}}});
       }},
      {"an index beyond the vertices", malformed, "/meshes/0/primitives/0/indices",
       [](auto& b) { b.bin[48] = std::byte{4}; }},
      {"a coordinate that is not a number", ErrorCode::invalid_geometry, "/meshes/0/primitives/0/attributes/POSITION",
       [](auto& b) { b.bin[14] = std::byte{0xff}, b.bin[15] = std::byte{0x7f}; }},
      {"attributes of different counts", malformed, "/meshes/0/primitives/0/attributes/_EXTRA",
       [](auto& b) {
         primitive_of(b)["attributes"]["_EXTRA"] = b.add_accessor(std::vector<float>{1, 2, 3}, "SCALAR", 1);
       }},
      {"sparse indices that do not increase", malformed, "/accessors/0/sparse/indices",
       [](auto& b) {
         const auto indices = b.add_view(bytes_of({std::uint8_t{1}, std::uint8_t{1}}));
         const auto values = b.add_view(test::Bytes(24));
         accessor_of(b, 0)["sparse"] = {{"count", 2},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", values}}}};
       }},
      {"a sparse index beyond the accessor", malformed, "/accessors/0/sparse/indices",
       [](auto& b) {
         const auto indices = b.add_view(bytes_of({std::uint8_t{4}}));
         const auto values = b.add_view(test::Bytes(12));
         accessor_of(b, 0)["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", values}}}};
       }},
      {"more sparse values than elements", malformed, "/accessors/0/sparse/count",
       [](auto& b) {
         accessor_of(b, 0)["sparse"] = {{"count", 5}};
       }},
      {"sparse values beyond their view", malformed, "/accessors/0/sparse/values",
       [](auto& b) {
         const auto indices = b.add_view(bytes_of({std::uint8_t{1}, std::uint8_t{2}}));
         accessor_of(b, 0)["sparse"] = {{"count", 2},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", b.add_view(test::Bytes(12))}}}};
       }},
      {"a node that is its own child", malformed, "/nodes/0/children",
       [](auto& b) { b.json["nodes"][0]["children"] = {0}; }},
      {"two nodes that are each other's child", malformed, "/nodes/0/children",
       [](auto& b) {
         b.json["nodes"].push_back(Json{{"children", {0}}});
         b.json["nodes"][0]["children"] = {1};
       }},
      {"a node with two parents", malformed, "/nodes/1/children/0",
       [](auto& b) {
         b.json["nodes"] = Json::array({Json{{"children", {2}}}, Json{{"children", {2}}}, Json{{"mesh", 0}}});
       }},
      {"a child that is not there", malformed, "/nodes/0/children/0",
       [](auto& b) { b.json["nodes"][0]["children"] = {5}; }},
      {"20,000 nested nodes", ErrorCode::too_large, "/nodes/2000",
       [](auto& b) {
         for (int i = 1; i < 20000; ++i) b.json["nodes"].push_back(Json{{"mesh", 0}});
         for (int i = 1; i < 20000; ++i) b.json["nodes"][static_cast<std::size_t>(i - 1)]["children"] = {i};
       }},
      {"a matrix of 15 numbers", malformed, "/nodes/0/matrix",
       [](auto& b) { b.json["nodes"][0]["matrix"] = std::vector<int>(15, 1); }},
      {"a node that scales its mesh to nothing", ErrorCode::invalid_geometry, "/nodes/0",
       [](auto& b) {
         b.json["nodes"][0]["scale"] = {0, 0, 0};
       }},
      {"a parent that scales the mesh to nothing", ErrorCode::invalid_geometry, "/nodes/0",
       [](auto& b) {
         b.json["nodes"].push_back(Json{{"children", {0}}, {"scale", {0, 0, 1}}});
       }},
      {"a mesh of points only", ErrorCode::invalid_geometry, "", [](auto& b) { primitive_of(b)["mode"] = 0; }},
      {"no mesh at all", ErrorCode::invalid_geometry, "",
       [](auto& b) {
         b.json.erase("meshes");
         b.json["nodes"][0].erase("mesh");
       }},
      {"a texture with an image that is not there", malformed, "/textures/0/source",
       [](auto& b) {
         b.append("textures", Json{{"source", 0}});
       }},
      {"a texture info without a number", malformed, "/materials/0/pbrMetallicRoughness/baseColorTexture/index",
       [](auto& b) {
         b.append("materials", Json{{"pbrMetallicRoughness", {{"baseColorTexture", Json::object()}}}});
       }},
      {"meshopt data that is damaged", malformed, "/bufferViews/0",
       [](auto& b) {
         view_of(b, 0)["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}};
       }},
      {"meshopt sizes that do not match", malformed, "/bufferViews/0/extensions/EXT_meshopt_compression/count",
       [](auto& b) {
         view_of(b, 0)["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 5}, {"mode", "ATTRIBUTES"}};
       }},
      {"an unknown meshopt mode", ErrorCode::unsupported_feature, "/bufferViews/0",
       [](auto& b) {
         view_of(b, 0)["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 4}, {"mode", "SPLATS"}};
       }},
      {"Draco data that is none", malformed, "/meshes/0/primitives/0",
       [](auto& b) {
         primitive_of(b)["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0},
                                                                        {"attributes", {{"POSITION", 0}}}};
       }},
      {"a Draco extension without a view", malformed,
       "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/bufferView",
       [](auto& b) { primitive_of(b)["extensions"]["KHR_draco_mesh_compression"] = Json::object(); }},
  };
  return list;
}

} // namespace

TEST_CASE("each defect of a document is refused with its code and place") {
  for (const Case& c : cases()) {
    CAPTURE(std::string(c.name));
    GltfBuilder b = test::tetrahedron();
    c.damage(b);
    const Error error = error_of(b.glb());
    INFO(error.message());
    CHECK(error.code() == c.code);
    CHECK(error.where() == std::string(c.where));
    CHECK_FALSE(error.message().empty());
  }
}

TEST_CASE("each defect of a container is refused") {
  const test::Bytes good = test::tetrahedron().glb();
  const auto with_word = [&](std::size_t at, std::uint32_t value) {
    test::Bytes bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
  };
  const auto cut = [&](std::size_t size) { return test::Bytes(good.begin(), good.begin() + static_cast<long>(size)); };
  CHECK(error_of({}).code() == malformed);
  CHECK(error_of(bytes_of("a letter to somebody")).code() == ErrorCode::unsupported_format);
  CHECK(error_of(bytes_of("{\"asset\"")).code() == malformed);
  CHECK(error_of(bytes_of("[1]")).code() == malformed);
  CHECK(error_of(bytes_of("{\"a\":1e999}")).code() == malformed);
  CHECK(error_of(bytes_of("{\"a\":\"\xff\"}")).code() == malformed);
  CHECK(error_of(with_word(4, 1)).code() == ErrorCode::unsupported_format);
  CHECK(error_of(with_word(8, 0xfffffff0)).code() == malformed);
  CHECK(error_of(with_word(12, 0xfffffff0)).code() == malformed);
  CHECK(error_of(with_word(16, 0x004E4942)).code() == malformed);
  for (const std::size_t size : {4u, 11u, 12u, 19u, 40u}) {
    CAPTURE(size);
    CHECK(error_of(cut(size)).code() == malformed);
  }
  test::Bytes two = good;
  const test::Bytes second = bytes_of({std::uint32_t{0}, std::uint32_t{0x004E4942}});
  two.insert(two.end(), second.begin(), second.end());
  const auto length = static_cast<std::uint32_t>(two.size());
  std::memcpy(two.data() + 8, &length, sizeof length);
  CHECK(error_of(two).code() == malformed);
}

TEST_CASE("JSON that would take too much to parse is refused before it is parsed") {
  CHECK(error_of(bytes_of("{\"a\":" + std::string(200000, '['))).code() == ErrorCode::too_large);
  std::string keys = "{\"k\":0";
  for (int i = 0; i < 2000; ++i) keys += ",\"k" + std::to_string(i) + "\":0";
  CHECK(error_of(bytes_of(keys + "}")).code() == ErrorCode::too_large);
  std::string values = "{\"a\":[0";
  for (int i = 0; i < (1 << 23); ++i) values += ",0";
  CHECK(error_of(bytes_of(values + "]}")).code() == ErrorCode::too_large);
}

TEST_CASE("brackets inside strings do not count as nesting") {
  GltfBuilder b = test::tetrahedron();
  b.json["asset"]["generator"] = std::string(500, '[') + "\"\\" + std::string(500, '{');
  CHECK(read_asset(b.glb(), {}, Limits{}).primitives.size() == 1);
}

TEST_CASE("each limit is named when it is exceeded") {
  const test::Bytes bytes = test::tetrahedron().glb();
  Limits limits;
  limits.max_triangles = 3;
  CHECK(error_of(bytes, limits).code() == ErrorCode::too_large);
  CHECK(error_of(bytes, limits).message().find("3 triangles") != std::string::npos);
  limits = {};
  limits.max_vertices = 3;
  CHECK(error_of(bytes, limits).message().find("3 vertices") != std::string::npos);
  limits = {};
  limits.max_bytes = 100;
  CHECK(error_of(bytes, limits).message().find("limit of 100") != std::string::npos);
  limits = {};
  limits.max_json_depth = 4;
  CHECK(error_of(bytes, limits).message().find("limit of 4") != std::string::npos);
}

TEST_CASE("many primitives that share one accessor count once each against the limits") {
  GltfBuilder b = test::tetrahedron();
  for (int i = 0; i < 9; ++i) b.json["meshes"][0]["primitives"].push_back(primitive_of(b));
  Limits limits;
  limits.max_vertices = 40;
  CHECK(read_asset(b.glb(), {}, limits).primitives.size() == 10);
  limits.max_vertices = 39;
  CHECK(error_of(b.glb(), limits).code() == ErrorCode::too_large);
}

TEST_CASE("no message shows the machine or a library") {
  for (const Case& c : cases()) {
    GltfBuilder b = test::tetrahedron();
    c.damage(b);
    const std::string message = error_of(b.glb()).message();
    CAPTURE(message);
    for (const auto word : {"json.exception", "nlohmann", "tinygltf", "std::", "/usr", "/home", "/tmp"}) {
      CHECK(message.find(word) == std::string::npos);
    }
  }
}

TEST_CASE("a scale of zero is no defect where something may undo it") {
  const auto reads = [](const std::function<void(GltfBuilder&)>& change) {
    GltfBuilder b = test::tetrahedron();
    b.json["nodes"][0]["scale"] = {0, 0, 0};
    change(b);
    return read_asset(b.glb(), {}, Limits{}).primitives.size() == 1;
  };
  CHECK(reads([](GltfBuilder& b) { b.json["nodes"].push_back(Json{{"mesh", 0}}); }));
  CHECK(reads([](GltfBuilder& b) {
    const auto time = b.add_accessor(std::vector<float>{0}, "SCALAR", 1);
    const auto scale = b.add_accessor(std::vector<float>{1, 1, 1}, "VEC3", 3);
    b.append("animations",
             Json{{"channels", Json::array({Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})},
                  {"samplers", Json::array({Json{{"input", time}, {"output", scale}}})}});
  }));
  CHECK(reads([](GltfBuilder& b) { b.json["nodes"][0]["scale"] = {1, 1, 0}; })); // flat, but not nothing
}
