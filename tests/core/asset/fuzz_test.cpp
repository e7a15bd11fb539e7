// Small valid files with a few bytes changed, thousands of times: whatever comes, only orbis::Error may come out.
// The seeds are fixed, so that a failure repeats; run it under AddressSanitizer to see more.
#include <doctest/doctest.h>

#include <functional>
#include <random>

#include "core/asset/asset.h"
#include "core/asset/draco_encoder.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::GltfBuilder;
using Json = nlohmann::ordered_json;

namespace {

constexpr int rounds = 1500;

Limits small_limits() {
  Limits limits;
  limits.max_triangles = 10000;
  limits.max_vertices = 10000;
  limits.max_bytes = 1 << 20;
  return limits;
}

// A file with most features that are read: strides, sparse values, morph targets, a texture, an animation, a small
// tree.
GltfBuilder full() {
  GltfBuilder b = test::tetrahedron();
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] =
      b.add_accessor(std::vector<std::uint8_t>{0, 0, 1, 0, 0, 1, 1, 1}, "VEC2", 2, true);
  primitive["targets"] = Json::array({Json{{"POSITION", b.add_accessor(test::tetrahedron_positions, "VEC3", 3)}}});
  const auto indices = b.add_view(test::bytes_of({std::uint8_t{1}, std::uint8_t{3}}));
  const auto values = b.add_view(test::bytes_of({1.f, 2.f, 3.f, 4.f, 5.f, 6.f}));
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  primitive["material"] = 0;
  b.append("images", Json{{"bufferView", b.add_view(test::tiny_png())}, {"mimeType", "image/png"}});
  b.append("textures", Json{{"source", 0}, {"sampler", b.append("samplers", Json{{"wrapS", 33071}})}});
  b.append(
      "materials",
      Json{{"pbrMetallicRoughness",
            {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}}});
  b.append("nodes", Json{{"children", {0}}, {"scale", {1, 2, 3}}});
  const auto time = b.add_accessor(std::vector<float>{0}, "SCALAR", 1);
  b.append("animations",
           Json{{"channels", Json::array({Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})},
                {"samplers", Json::array({Json{{"input", time}, {"output", 0}}})}});
  return b;
}

test::Bytes compressed() {
  const GltfBuilder b = full();
  const Asset asset = read_asset(b.glb(), {}, Limits{});
  const Primitive& p = asset.primitives.at(0);
  return write_asset(asset, std::vector{NewPrimitive{p.indices, p.attributes, p.targets, 0, {}, false}},
                     std::vector{NewImage{test::tiny_png(), "image/png"}}, "{}", Compression::draco);
}

test::Bytes mutated(test::Bytes bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t changes = 1 + below(4);
  for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
    std::byte& at = bytes[below(bytes.size())];
    switch (below(5)) {
    case 0:
      at = static_cast<std::byte>(random() & 0xff);
      break;
    case 1:
      at ^= static_cast<std::byte>(1u << below(8));
      break;
    case 2:
      at = static_cast<std::byte>('0' + below(10));
      break;
    case 3:
      bytes.erase(bytes.begin() + static_cast<long>(below(bytes.size())));
      break;
    default:
      bytes.resize(bytes.size() - below(std::min<std::size_t>(bytes.size(), 16)));
      break;
    }
  }
  return bytes;
}

// One value of the document is replaced by a hostile one.
void mutate_json(Json& json, std::mt19937& random) {
  static const std::vector<Json> hostile{nullptr,
                                         true,
                                         -1,
                                         0,
                                         1,
                                         2,
                                         255,
                                         65536,
                                         4294967295u,
                                         18446744073709551615ull,
                                         0.5,
                                         1e300,
                                         "",
                                         ".",
                                         "data:;base64,AAAA",
                                         Json::array(),
                                         Json::object(),
                                         Json::array({0, 0}),
                                         Json{{"index", 0}}};
  Json* at = &json;
  while (at->is_structured() && !at->empty() && random() % 8 != 0) {
    auto it = at->begin();
    std::advance(it, static_cast<long>(random() % at->size()));
    at = &*it;
  }
  *at = hostile[random() % hostile.size()];
}

// Reads, and writes what could be read. Returns whether it could.
bool survives(const test::Bytes& bytes) {
  try {
    const Asset asset = read_asset(bytes, {}, small_limits());
    std::vector<NewPrimitive> primitives;
    for (const Primitive& p : asset.primitives) {
      for (std::size_t slot = 0; slot < texture_slots; ++slot)
        (void)material_texture(asset, p, static_cast<TextureSlot>(slot));
      primitives.push_back({p.indices, p.attributes, p.targets, 0, {{TextureSlot::base_color, 0}}});
      if (!p.find("TEXCOORD_0")) {
        primitives.back().attributes.push_back(
            {"TEXCOORD_0", ComponentType::f32, false, 2, Bytes(p.vertex_count() * 8)});
      }
    }
    const Bytes out =
        write_asset(asset, primitives, std::vector{NewImage{test::tiny_png(), "image/png"}}, "{}", Compression::none);
    (void)read_asset(out, {}, Limits{});
    return true;
  } catch (const Error& error) {
    CHECK(error.code() != ErrorCode::internal);
    return false;
  }
}

void check_mutations(const char* name, unsigned seed, const std::function<test::Bytes(std::mt19937&)>& make) {
  std::mt19937 random(seed);
  int read = 0;
  for (int i = 0; i < rounds; ++i) {
    CAPTURE(name);
    CAPTURE(i);
    try {
      read += survives(make(random));
    } catch (const std::exception& other) {
      FAIL_CHECK("another exception came out: " << other.what());
    }
  }
  MESSAGE(std::string(name) << ": " << read << " of " << rounds << " mutations could still be read");
  CHECK(read < rounds);
}

} // namespace

TEST_CASE("nothing but Error comes out of damaged files") {
  const test::Bytes glb = full().glb(), gltf = full().gltf(), draco_in_gltf = compressed();
  const Asset asset = read_asset(glb, {}, Limits{});
  const test::Bytes draco = encode_draco(asset.primitives.at(0).indices, asset.primitives[0].attributes);
  for (const test::Bytes& good : {glb, gltf, draco_in_gltf, draco}) CHECK(survives(good));
  check_mutations("GLB", 1, [&](std::mt19937& random) { return mutated(glb, random); });
  check_mutations("glTF", 2, [&](std::mt19937& random) { return mutated(gltf, random); });
  check_mutations("Draco in glTF", 3, [&](std::mt19937& random) { return mutated(draco_in_gltf, random); });
  check_mutations("Draco", 4, [&](std::mt19937& random) { return mutated(draco, random); });
}

TEST_CASE("nothing but Error comes out of documents with hostile values") {
  check_mutations("JSON", 5, [](std::mt19937& random) {
    GltfBuilder b = full();
    b.json["buffers"] = Json::array({Json{{"byteLength", b.bin.size()}}});
    for (std::size_t i = 0; i < 1 + random() % 2; ++i) mutate_json(b.json, random);
    return test::glb_of(b.json.dump(), b.bin);
  });
}
