// What read_asset makes of every way in which glTF can store triangles.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;
using test::GltfBuilder;
using test::tetrahedron;
using Json = nlohmann::ordered_json;

namespace {

Asset read(const test::Bytes& bytes, const Attachments& attachments = {}) {
  return read_asset(bytes, attachments, Limits{});
}

using Indices = std::vector<std::uint32_t>;
const Indices tetrahedron_triangles(test::tetrahedron_indices.begin(), test::tetrahedron_indices.end());

// A square fan of four corners drawn with `mode`.
Asset read_mode(int mode, std::optional<std::vector<std::uint16_t>> indices, std::size_t vertices = 5) {
  GltfBuilder b;
  std::vector<float> positions;
  for (std::size_t v = 0; v < vertices; ++v) {
    positions.insert(positions.end(), {static_cast<float>(v), static_cast<float>(v * v), 0});
  }
  Json primitive{{"attributes", {{"POSITION", b.add_accessor(positions, "VEC3", 3)}}}, {"mode", mode}};
  if (indices) primitive["indices"] = b.add_accessor(*indices, "SCALAR", 1);
  b.add_mesh(primitive);
  return read(b.glb());
}

// The tetrahedron with an extra attribute of type T; what comes back is compared to the bit.
template <class T>
void check_attribute(const std::vector<T>& values, std::string_view type, std::size_t components, bool normalized) {
  CAPTURE(test::component_code<T>());
  CAPTURE(type);
  GltfBuilder b = tetrahedron();
  b.json["meshes"][0]["primitives"][0]["attributes"]["_EXTRA"] = b.add_accessor(values, type, components, normalized);
  const Asset asset = read(b.glb());
  const Attribute* extra = asset.primitives.at(0).find("_EXTRA");
  REQUIRE(extra);
  CHECK(static_cast<int>(extra->type) == test::component_code<T>());
  CHECK(extra->components == components);
  CHECK(extra->normalized == normalized);
  CHECK(extra->count() == 4);
  CHECK(extra->data == bytes_of(std::span<const T>(values)));
}

} // namespace

TEST_CASE("a GLB, the same as JSON with a data URI, and the same with a file beside it read alike") {
  const GltfBuilder b = tetrahedron();
  const Asset glb = read(b.glb());
  CHECK(glb.format == ModelFormat::glb);
  REQUIRE(glb.primitives.size() == 1);
  CHECK(glb.primitives[0].indices == tetrahedron_triangles);
  CHECK(glb.primitives[0].vertex_count() == 4);
  CHECK(glb.primitives[0].positions()[1] == Vec3f{-1, -1, 1});
  CHECK_FALSE(glb.primitives[0].material);
  CHECK(glb.notes.empty());

  const Asset gltf = read(b.gltf());
  CHECK(gltf.format == ModelFormat::gltf);
  CHECK(gltf.primitives.at(0).indices == tetrahedron_triangles);
  CHECK(gltf.primitives[0].attributes[0].data == glb.primitives[0].attributes[0].data);

  Json with_file = b.json;
  with_file["buffers"] = Json::array({Json{{"byteLength", b.bin.size()}, {"uri", "sub%20dir/data.bin"}}});
  for (const auto name : {"sub dir/data.bin", "data.bin"}) {
    const Asset read_back = read(bytes_of(with_file.dump()), {{name, b.bin}});
    CHECK(read_back.primitives.at(0).attributes[0].data == glb.primitives[0].attributes[0].data);
  }
}

TEST_CASE("a byte order mark and white space before the JSON do no harm") {
  CHECK(read(bytes_of("\xEF\xBB\xBF \n" + std::string(reinterpret_cast<const char*>(tetrahedron().gltf().data()),
                                                      tetrahedron().gltf().size())))
            .primitives.size() == 1);
}

TEST_CASE("strips and fans become lists with the winding of the specification") {
  CHECK(read_mode(4, std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3}).primitives[0].indices == Indices{0, 1, 2, 2, 1, 3});
  CHECK(read_mode(5, std::vector<std::uint16_t>{0, 1, 2, 3, 4}).primitives[0].indices ==
        Indices{0, 1, 2, 1, 3, 2, 2, 3, 4});
  CHECK(read_mode(6, std::vector<std::uint16_t>{0, 1, 2, 3, 4}).primitives[0].indices ==
        Indices{1, 2, 0, 2, 3, 0, 3, 4, 0});
}

TEST_CASE("a primitive without indices takes its vertices in order") {
  CHECK(read_mode(4, std::nullopt, 6).primitives[0].indices == Indices{0, 1, 2, 3, 4, 5});
  CHECK(read_mode(5, std::nullopt, 4).primitives[0].indices == Indices{0, 1, 2, 1, 3, 2});
  CHECK(read_mode(6, std::nullopt, 4).primitives[0].indices == Indices{1, 2, 0, 2, 3, 0});
}

TEST_CASE("indices that are left over are dropped, and a note says so") {
  const Asset asset = read_mode(4, std::vector<std::uint16_t>{0, 1, 2, 3});
  CHECK(asset.primitives[0].indices == Indices{0, 1, 2});
  REQUIRE(asset.notes.size() == 1);
  CHECK(asset.notes[0].code == "incomplete-triangle");
}

TEST_CASE("indices of every unsigned type read alike") {
  const auto read_with = [](auto zero) {
    using T = decltype(zero);
    GltfBuilder b = tetrahedron();
    const std::vector<T> indices(test::tetrahedron_indices.begin(), test::tetrahedron_indices.end());
    b.json["meshes"][0]["primitives"][0]["indices"] = b.add_accessor(indices, "SCALAR", 1);
    return read(b.glb()).primitives.at(0).indices;
  };
  CHECK(read_with(std::uint8_t{}) == tetrahedron_triangles);
  CHECK(read_with(std::uint16_t{}) == tetrahedron_triangles);
  CHECK(read_with(std::uint32_t{}) == tetrahedron_triangles);
}

TEST_CASE("attributes of every component type come back to the bit") {
  check_attribute<std::int8_t>({-128, -127, 0, 127}, "SCALAR", 1, false);
  check_attribute<std::uint8_t>({0, 1, 2, 3, 4, 5, 254, 255}, "VEC2", 2, true);
  check_attribute<std::int16_t>({-32768, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 32767}, "VEC3", 3, true);
  check_attribute<std::uint16_t>({0, 65535, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14}, "VEC4", 4, false);
  check_attribute<std::uint32_t>({0, 1, 4294967294u, 4294967295u}, "SCALAR", 1, false);
  check_attribute<float>({-0.0f, std::numeric_limits<float>::denorm_min(), -1e-38f, 1e38f}, "SCALAR", 1, false);
}

TEST_CASE("quantised positions read as the numbers they stand for") {
  GltfBuilder b = tetrahedron();
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  // Three components of 16 bits: every vertex is padded to 8 bytes.
  const std::vector<std::int16_t> stored{32767, 0, -32768, 0, -32767, 1, 2, 3, 0, 4, 5, 6, 0, 0, 0, 0};
  const auto view = b.add_view(bytes_of(std::span<const std::int16_t>(stored)), 8);
  b.json["accessors"][0] =
      Json{{"bufferView", view}, {"componentType", 5122}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}};
  const Primitive primitive = read(b.glb()).primitives.at(0);
  CHECK(primitive.positions()[0] == Vec3f{1, 0, -1});
  CHECK(primitive.positions()[1] == Vec3f{-1, 1.0f / 32767, 2.0f / 32767});
  CHECK(primitive.attributes[0].data.size() == 4 * 6);
}

TEST_CASE("interleaved attributes are taken apart") {
  GltfBuilder b;
  std::vector<float> mixed;
  for (std::size_t v = 0; v < 4; ++v) {
    mixed.insert(mixed.end(), test::tetrahedron_positions.begin() + static_cast<long>(3 * v),
                 test::tetrahedron_positions.begin() + static_cast<long>(3 * v + 3));
    mixed.insert(mixed.end(), {static_cast<float>(v), 0.5f});
  }
  const auto view = b.add_view(bytes_of(std::span<const float>(mixed)), 20);
  const auto accessor = [&](std::size_t offset, const char* type) {
    return b.append(
        "accessors",
        Json{{"bufferView", view}, {"byteOffset", offset}, {"componentType", 5126}, {"count", 4}, {"type", type}});
  };
  const auto position = accessor(0, "VEC3"), uv = accessor(12, "VEC2");
  b.add_mesh(Json{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}},
                  {"indices", b.add_accessor(test::tetrahedron_indices, "SCALAR", 1)}});
  const Primitive primitive = read(b.glb()).primitives.at(0);
  CHECK(primitive.find("POSITION")->data == bytes_of(std::span<const float>(test::tetrahedron_positions)));
  CHECK(primitive.find("TEXCOORD_0")->get(3, 0) == 3.0);
  CHECK(primitive.find("TEXCOORD_0")->get(3, 1) == 0.5);
}

TEST_CASE("sparse values replace those of the view, or zeros where there is none") {
  for (const bool has_view : {true, false}) {
    CAPTURE(has_view);
    GltfBuilder b = tetrahedron();
    Json& accessor = b.json["accessors"][0];
    const auto indices = b.add_view(bytes_of({std::uint8_t{1}, std::uint8_t{3}}));
    const auto values = b.add_view(bytes_of({10.f, 11.f, 12.f, 13.f, 14.f, 15.f}));
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                          {"values", {{"bufferView", values}}}};
    if (!has_view) accessor.erase("bufferView");
    const auto positions = read(b.glb()).primitives.at(0).positions();
    CHECK(positions[0] == (has_view ? Vec3f{1, 1, 1} : Vec3f{}));
    CHECK(positions[1] == Vec3f{10, 11, 12});
    CHECK(positions[2] == (has_view ? Vec3f{-1, 1, -1} : Vec3f{}));
    CHECK(positions[3] == Vec3f{13, 14, 15});
  }
}

TEST_CASE("morph targets, materials and the place in the document are kept") {
  GltfBuilder b = tetrahedron();
  b.append("materials", Json{{"name", "m"}});
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["targets"] = Json::array({Json{{"POSITION", b.add_accessor(test::tetrahedron_positions, "VEC3", 3)}}});
  // A primitive of points comes first: it stays in the document and is not read.
  b.json["meshes"][0]["primitives"].insert(b.json["meshes"][0]["primitives"].begin(),
                                           Json{{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  const Asset asset = read(b.glb());
  REQUIRE(asset.primitives.size() == 1);
  CHECK(asset.primitives[0].mesh == 0);
  CHECK(asset.primitives[0].primitive == 1);
  CHECK(asset.primitives[0].material == 0u);
  REQUIRE(asset.primitives[0].targets.size() == 1);
  CHECK(asset.primitives[0].targets[0].at(0).name == "POSITION");
}

TEST_CASE("numbers of an attribute go in and out as the specification says") {
  const auto make = [](ComponentType type, bool normalized) {
    return Attribute{"_A", type, normalized, 1, test::Bytes(size_of(type))};
  };
  Attribute byte = make(ComponentType::i8, true);
  byte.set(0, 0, -1.0);
  CHECK(byte.get(0, 0) == -1.0);
  byte.data[0] = std::byte{0x80}; // -128 stands for -1 too
  CHECK(byte.get(0, 0) == -1.0);
  byte.set(0, 0, 7.5);
  CHECK(byte.get(0, 0) == 1.0);

  Attribute small = make(ComponentType::u16, false);
  small.set(0, 0, 70000);
  CHECK(small.get(0, 0) == 65535);
  small.set(0, 0, -3);
  CHECK(small.get(0, 0) == 0);
  small.set(0, 0, 2.5);
  CHECK(small.get(0, 0) == 3);
  small.set(0, 0, std::nan(""));
  CHECK(small.get(0, 0) == 0);

  for (const ComponentType type : {ComponentType::i8, ComponentType::u8, ComponentType::i16, ComponentType::u16}) {
    Attribute attribute = make(type, true);
    const int steps = size_of(type) == 1 ? 255 : 65535;
    int wrong = 0;
    for (int i = 0; i <= steps; ++i) {
      std::memcpy(attribute.data.data(), &i, size_of(type));
      const double value = attribute.get(0, 0);
      Attribute copy = make(type, true);
      copy.set(0, 0, value);
      wrong += copy.get(0, 0) != value;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("an image that did not come is a note where the model came alone") {
  GltfBuilder b = tetrahedron();
  for (const auto uri : {"http://127.0.0.1:1/a.png", "../../../../etc/passwd"}) b.append("images", Json{{"uri", uri}});
  const Asset asset = read(b.glb());
  REQUIRE(asset.notes.size() == 2);
  CHECK(asset.notes[0].code == "image-missing");
  CHECK(asset.notes[0].where == "/images/0");
  CHECK(asset.notes[1].where == "/images/1");
}

TEST_CASE("a file is found by its decoded name, and by its name as it is written") {
  GltfBuilder b = tetrahedron();
  b.append("images", Json{{"uri", "folder/a%20b.png"}});
  CHECK(read(b.glb(), {{"a b.png", test::tiny_png()}}).notes.empty());
  CHECK(read(b.glb(), {{"a%20b.png", test::tiny_png()}}).notes.empty());
  CHECK_THROWS_AS((void)read(b.glb(), {{"a+b.png", test::tiny_png()}}), Error);
}

TEST_CASE("where files came along, an image that did not is an error that names it, unless it lies elsewhere") {
  GltfBuilder b = tetrahedron();
  for (const auto uri : {"http://127.0.0.1:1/a.png", "a.png"}) b.append("images", Json{{"uri", uri}});
  CHECK(read(b.glb(), {{"a.png", test::tiny_png()}}).notes.size() == 1);
  b.append("images", Json{{"uri", "b.png"}});
  try {
    (void)read(b.glb(), {{"a.png", test::tiny_png()}});
    FAIL("the model was read");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::missing_resource);
    CHECK(error.message().find("'b.png'") != std::string::npos);
    CHECK(error.where() == "/images/2/uri");
  }
}
