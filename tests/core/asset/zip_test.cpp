// Zip archives: what is read from them, and what they may not do.
#include <doctest/doctest.h>

#include "core/asset/asset.h"
#include "core/asset/zip.h"
#include "support/zip_builder.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;
using test::zip_of;
using test::ZipMember;

namespace {

const test::Bytes glb = test::tetrahedron().glb();

Error error_of(const test::Bytes& zip, const Limits& limits = {}) {
  try {
    (void)read_asset(zip, {}, limits);
  } catch (const Error& error) {
    return error;
  }
  FAIL("the archive was read");
  return Error(ErrorCode::internal, "unreachable");
}

// A glTF with an external buffer and image in a folder of its own.
test::Bytes gltf_with_files() {
  test::GltfBuilder b = test::tetrahedron();
  b.append("images", {{"uri", "textures/a%20b.png"}});
  b.json["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", "shared.bin"}}};
  return bytes_of(b.json.dump());
}

} // namespace

TEST_CASE("a zip with one model is read like the model itself") {
  const Asset asset = read_asset(zip_of({{"tetrahedron.glb", glb}}), {}, Limits{});
  CHECK(asset.format == ModelFormat::glb);
  CHECK(asset.primitives.at(0).indices.size() == 12);
}

TEST_CASE("a glTF finds its files in the zip, from its own folder") {
  const test::Bytes bin = test::tetrahedron().bin;
  const auto model = unzip_model(zip_of({{"scene/model.gltf", gltf_with_files()},
                                         {"scene/", {}},
                                         {"__MACOSX/scene/._model.gltf", bytes_of("litter")},
                                         {"scene/textures/a b.png", test::tiny_png()},
                                         {"common/other.png", test::tiny_png()},
                                         {"scene/shared.bin", bin}}),
                                 Limits{});
  CHECK(model.name == "scene/model.gltf");
  CHECK(model.files.size() == 3);
  CHECK(model.files.at("shared.bin") == bin);
  CHECK(model.files.contains("textures/a b.png"));
  CHECK(model.files.contains("../common/other.png"));
}

TEST_CASE("a file that the zip lacks is named") {
  const Error error = error_of(zip_of({{"m.gltf", gltf_with_files()}, {"shared.bin", test::tetrahedron().bin}}));
  CHECK(error.code() == ErrorCode::missing_resource);
  CHECK(error.message().find("textures/a%20b.png") != std::string::npos);
  CHECK(error.where() == "/images/0/uri");
}

TEST_CASE("a zip without a model, or with two, is refused by their names") {
  CHECK(error_of(zip_of({{"readme.txt", bytes_of("hello")}})).code() == ErrorCode::missing_resource);
  const Error two = error_of(zip_of({{"a.glb", glb}, {"b.OBJ", bytes_of("v 0 0 0\n")}}));
  CHECK(two.code() == ErrorCode::unsupported_feature);
  CHECK(two.message().find("'a.glb' and 'b.OBJ'") != std::string::npos);
  CHECK(error_of(zip_of({{"a.glb", zip_of({{"b.glb", glb}})}})).code() == ErrorCode::unsupported_format);
}

TEST_CASE("names that lead out of the archive are refused") {
  for (const auto name : {"../a.bin", "a/../../b", "/etc/passwd", "C:/a.bin", "..\\a.bin", ".."}) {
    CAPTURE(name);
    const Error error = error_of(zip_of({{"model.glb", glb}, {name, bytes_of("x")}}));
    CHECK(error.code() == ErrorCode::malformed);
    CHECK(error.message().find("leads out of the archive") != std::string::npos);
  }
}

TEST_CASE("sizes are limited before anything is inflated") {
  Limits limits;
  limits.max_bytes = 4000;
  CHECK(error_of(zip_of({{"model.glb", glb}, {"big", test::Bytes(3900)}}), limits).code() == ErrorCode::too_large);
  // A bomb: a few bytes that claim to be three gigabytes, and the same within the limit.
  CHECK(error_of(zip_of({{"model.glb", glb}, {"bomb", test::Bytes(10), 8, 0, 3'000'000'000}})).code() ==
        ErrorCode::too_large);
  const Error ratio = error_of(zip_of({{"model.glb", glb}, {"bomb", test::Bytes(10), 8, 0, 100'000'000}}));
  CHECK(ratio.code() == ErrorCode::too_large);
  CHECK(ratio.message().find("200 times") != std::string::npos);
  CHECK(error_of(zip_of(std::vector<ZipMember>(5000, {"a", {}}))).message().find("4096") != std::string::npos);
}

TEST_CASE("what a member claims is held against what comes out") {
  test::Bytes damaged = zip_of({{"model.glb", glb}});
  damaged[60] ^= std::byte{1}; // within the contents: the checksum tells
  CHECK(error_of(damaged).code() == ErrorCode::malformed);
  const auto claimed = static_cast<std::uint32_t>(glb.size() + 10);
  CHECK(error_of(zip_of({{"model.glb", glb, 0, 0, claimed}})).code() == ErrorCode::malformed);
  test::Bytes cut = zip_of({{"model.glb", glb}});
  cut.resize(cut.size() - 30);
  CHECK(error_of(cut).code() == ErrorCode::malformed);
}

TEST_CASE("encrypted members and other methods are refused") {
  CHECK(error_of(zip_of({{"model.glb", glb, 0, 1}})).code() == ErrorCode::unsupported_feature);
  CHECK(error_of(zip_of({{"model.glb", glb, 12}})).code() == ErrorCode::unsupported_feature);
}
