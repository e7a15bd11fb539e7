// Raw Draco files, and the defence against what damaged ones claim.
#include <doctest/doctest.h>

#include "core/asset/asset.h"
#include "core/asset/draco_encoder.h"
#include "core/asset/draco_header.h"
#include "core/asset/glb.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;
using Json = nlohmann::ordered_json;

namespace {

const std::vector<std::uint32_t> triangles(test::tetrahedron_indices.begin(), test::tetrahedron_indices.end());

Attribute attribute(std::string name, ComponentType type, std::uint32_t components, test::Bytes data,
                    bool normalized = false) {
  return {std::move(name), type, normalized, components, std::move(data)};
}

Attribute positions() {
  return attribute("POSITION", ComponentType::f32, 3, bytes_of(std::span<const float>(test::tetrahedron_positions)));
}

Error error_of(const test::Bytes& bytes, const Limits& limits = {}) {
  try {
    (void)read_asset(bytes, {}, limits);
  } catch (const Error& error) {
    return error;
  }
  FAIL("the file was read");
  return Error(ErrorCode::internal, "unreachable");
}

void append_varint(test::Bytes& to, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) to.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  to.push_back(static_cast<std::byte>(value));
}

// "DRACO", version 2.2, mesh, method, flags; then two counts.
test::Bytes header(std::uint8_t method, std::uint64_t first, std::uint64_t second, std::uint8_t geometry = 1) {
  test::Bytes out = bytes_of("DRACO");
  for (const std::uint8_t b : {std::uint8_t{2}, std::uint8_t{2}, geometry, method, std::uint8_t{0}, std::uint8_t{0}})
    out.push_back(std::byte{b});
  if (method == 1) out.push_back(std::byte{0}); // traversal
  append_varint(out, first);
  append_varint(out, second);
  out.resize(out.size() + 200);
  return out;
}

} // namespace

TEST_CASE("a raw Draco mesh reads to the bit, with glTF's names") {
  const std::vector<Attribute> attributes{
      positions(),
      attribute("NORMAL", ComponentType::f32, 3,
                bytes_of({1.f, 0.f, -0.0f, 0.f, -1.f, 0.f, 0.6f, 0.8f, 0.f, 0.f, 0.f, 1.f})),
      attribute("TEXCOORD_0", ComponentType::f32, 2, bytes_of({0.f, 1.f, 0.25f, -0.0f, 0.1f, 0.2f, 0.3f, 0.4f})),
      attribute("COLOR_0", ComponentType::u16, 3,
                bytes_of({std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{3}, std::uint16_t{4}, std::uint16_t{5},
                          std::uint16_t{6}, std::uint16_t{7}, std::uint16_t{8}, std::uint16_t{9}, std::uint16_t{65535},
                          std::uint16_t{0}, std::uint16_t{128}}),
                true),
      attribute("_GENERIC_0", ComponentType::i16, 1,
                bytes_of({std::int16_t{-5}, std::int16_t{5}, std::int16_t{32767}, std::int16_t{-32768}}))};
  const Asset asset = read_asset(encode_draco(triangles, attributes), {}, Limits{});
  CHECK(asset.format == ModelFormat::draco);
  CHECK(asset.notes.empty());
  REQUIRE(asset.primitives.size() == 1);
  const Primitive& primitive = asset.primitives[0];
  CHECK(primitive.indices == triangles);
  REQUIRE(primitive.attributes.size() == attributes.size());
  for (const Attribute& wanted : attributes) {
    CAPTURE(wanted.name);
    const Attribute* found = primitive.find(wanted.name);
    REQUIRE(found);
    CHECK(found->type == wanted.type);
    CHECK(found->normalized == wanted.normalized);
    CHECK(found->data == wanted.data);
  }
}

TEST_CASE("colours of 8 bits are sRGB in a raw Draco file as in a PLY, and linear in glTF; alpha is no colour") {
  test::Bytes rgba;
  for (int v = 0; v < 4; ++v) {
    for (const int c : {255, 128, 0, 51}) rgba.push_back(static_cast<std::byte>(c));
  }
  const auto colors = attribute("COLOR_0", ComponentType::u8, 4, rgba, true);
  const Asset asset = read_asset(encode_draco(triangles, std::vector{positions(), colors}), {}, Limits{});
  const Attribute* found = asset.primitives.at(0).find("COLOR_0");
  REQUIRE(found);
  CHECK(found->get(3, 0) == 1.0);
  CHECK(found->get(3, 1) == doctest::Approx(0.2159).epsilon(0.001));
  CHECK(found->get(3, 2) == 0.0);
  CHECK(found->get(3, 3) == doctest::Approx(0.2).epsilon(0.001));
}

TEST_CASE("a raw Draco mesh becomes a document with one scene, node, mesh and material") {
  const Asset asset = read_asset(encode_draco(triangles, std::vector{positions()}), {}, Limits{});
  const Primitive& p = asset.primitives.at(0);
  NewPrimitive out{p.indices, p.attributes, {}, 0, {}, false};
  out.attributes.push_back(attribute("TEXCOORD_0", ComponentType::f32, 2, test::Bytes(32)));
  out.textures[TextureSlot::base_color] = 0;
  const Bytes glb = write_asset(asset, std::vector{out}, std::vector{NewImage{test::tiny_png(), "image/png"}}, "{}",
                                Compression::none);
  const auto text = split_glb(glb).json;
  const Json json =
      Json::parse(reinterpret_cast<const char*>(text.data()), reinterpret_cast<const char*>(text.data()) + text.size());
  CHECK(json["scene"] == 0);
  CHECK(json["scenes"][0]["nodes"] == Json{0});
  CHECK(json["nodes"][0]["mesh"] == 0);
  CHECK(json["meshes"].size() == 1);
  CHECK(json["materials"].size() == 1);
  CHECK(read_asset(glb, {}, Limits{}).primitives.at(0).attributes.at(0).data == p.attributes[0].data);
}

TEST_CASE("integers that glTF cannot hold become floats, and a note says so") {
  const auto wide = attribute("_WIDE", ComponentType::u32, 1, bytes_of({1u, 2u, 3u, 4u}));
  const Asset asset = read_asset(encode_draco(triangles, std::vector{positions(), wide}), {}, Limits{});
  const Attribute* found = asset.primitives.at(0).find("_GENERIC_0");
  REQUIRE(found);
  CHECK(found->type == ComponentType::f32);
  CHECK(found->get(3, 0) == 4.0);
  REQUIRE(asset.notes.size() == 1);
  CHECK(asset.notes[0].code == "attribute-converted");
}

TEST_CASE("counts that a header claims are checked before anything is decoded") {
  CHECK(error_of(header(0, 4'000'000'000, 3)).code() == ErrorCode::too_large);
  CHECK(error_of(header(0, 4, 4'000'000'000)).code() == ErrorCode::too_large);
  CHECK(error_of(header(1, 4'000'000'000, 4)).code() == ErrorCode::too_large);
  CHECK(error_of(header(1, 4, 4'000'000'000)).code() == ErrorCode::too_large);
  // Within the limits, but not within 217 bytes.
  CHECK(error_of(header(0, 10'000'000, 20'000'000)).code() == ErrorCode::malformed);
  CHECK(error_of(header(0, 10'000'000, 20'000'000)).message().find("claims 10000000 triangles") != std::string::npos);
}

TEST_CASE("the header is read past metadata, and in the 32 bits of older versions") {
  test::Bytes old = header(0, 0, 0);
  old.resize(11);
  old[6] = std::byte{1}; // version 2.1
  const test::Bytes counts = bytes_of({7u, 9u});
  old.insert(old.end(), counts.begin(), counts.end());
  auto read = read_draco_header(old);
  REQUIRE(read);
  CHECK(read->faces == 7);
  CHECK(read->vertices == 9);

  test::Bytes with_metadata = header(0, 0, 0);
  with_metadata.resize(11);
  with_metadata[10] = std::byte{0x80};
  // One attribute's metadata (id 5) with one entry "k" of 2 bytes and one empty child "c"; then the file's, empty.
  for (const int b : {1, 5, 1, 1, 0x6b, 2, 0, 0, 1, 1, 0x63, 0, 0, 0, 0})
    with_metadata.push_back(static_cast<std::byte>(b));
  append_varint(with_metadata, 300);
  append_varint(with_metadata, 200);
  read = read_draco_header(with_metadata);
  REQUIRE(read);
  CHECK(read->faces == 300);
  CHECK(read->vertices == 200);
}

TEST_CASE("a point cloud, a cut file and text are refused with a reason") {
  CHECK(error_of(header(0, 1, 1, 0)).code() == ErrorCode::invalid_geometry);
  CHECK(error_of(header(0, 1, 1, 0)).message().find("point cloud") != std::string::npos);
  test::Bytes cut = encode_draco(triangles, std::vector{positions()});
  cut.resize(cut.size() / 2);
  CHECK(error_of(cut).code() == ErrorCode::malformed);
  CHECK(error_of(bytes_of("DRACO is a text")).code() == ErrorCode::malformed);
  CHECK(
      error_of(encode_draco(triangles, std::vector{attribute("_A", ComponentType::f32, 3, positions().data)})).code() ==
      ErrorCode::invalid_geometry);
}
