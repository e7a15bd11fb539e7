// Attributes that break the specification's rules are put right, and what was right keeps its bits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
using orbis::test::GltfBuilder;

namespace {

constexpr float no_number = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();

// A tetrahedron with one more attribute.
Asset with(const char* name, const char* type, std::size_t components, const std::vector<float>& values) {
  GltfBuilder b = test::tetrahedron();
  const auto accessor = b.add_accessor(values, type, components);
  b.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
  return read_asset(b.glb(), {}, {});
}

std::vector<float> values_of(const Asset& asset, const char* name) {
  const Attribute* a = asset.primitives.at(0).find(name);
  REQUIRE(a != nullptr);
  std::vector<float> out;
  for (std::size_t v = 0; v < a->count(); ++v)
    for (std::uint32_t c = 0; c < a->components; ++c) out.push_back(static_cast<float>(a->get(v, c)));
  return out;
}

std::string mended(const Asset& asset) {
  const auto note = std::ranges::find(asset.notes, "attribute-mended", &Asset::Note::code);
  return note == asset.notes.end() ? "" : note->message + " " + note->where;
}

} // namespace

TEST_CASE("attributes that keep the rules keep their bits, and nothing is said") {
  const float third = 1.0F / 3;
  const std::vector<float> weights{third, third, third, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0, 0, 0, 1};
  const Asset asset = with("WEIGHTS_0", "VEC4", 4, weights);
  CHECK(values_of(asset, "WEIGHTS_0") == weights);
  CHECK(mended(asset).empty());
}

TEST_CASE("numbers that are none become 0") {
  const Asset asset = with("TEXCOORD_0", "VEC2", 2, {no_number, 0.5F, 0.25F, infinite, 0, 1, 0.75F, 0});
  CHECK(values_of(asset, "TEXCOORD_0") == std::vector<float>{0, 0.5F, 0.25F, 0, 0, 1, 0.75F, 0});
  CHECK(
      mended(asset) ==
      "2 values of TEXCOORD_0 were infinite or no numbers, and are 0 now /meshes/0/primitives/0/attributes/TEXCOORD_0");
}

TEST_CASE("normals get unit length, and those without a direction the surface's") {
  const Asset asset = with("NORMAL", "VEC3", 3, {0, 0, 0, 0, 0, 5, 1, 0, 0, no_number, 0, 0});
  const std::vector<float> n = values_of(asset, "NORMAL");
  // The three triangles around a regular tetrahedron's corner add up to the direction of the corner.
  for (std::size_t c = 0; c < 3; ++c) CHECK(n[c] == doctest::Approx(1 / std::sqrt(3.0)));
  CHECK(n[3 + 2] == 1);
  CHECK(n[6 + 0] == 1);
  for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(n[9 + c]) == doctest::Approx(1 / std::sqrt(3.0)));
  CHECK_FALSE(mended(asset).empty());
}

TEST_CASE("tangents get a length and a sign, across the normal where they had no direction") {
  GltfBuilder b = test::tetrahedron();
  const auto normal = b.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0}, "VEC3", 3);
  const auto tangent = b.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 2, 0, -1, 1, 0, 0, 0, 0, 0, 0, -3}, "VEC4", 4);
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normal;
  b.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = tangent;
  const Asset asset = read_asset(b.glb(), {}, {});
  const std::vector<float> t = values_of(asset, "TANGENT"), n = values_of(asset, "NORMAL");
  for (std::size_t v = 0; v < 4; ++v) {
    CAPTURE(v);
    CHECK(std::hypot(t[4 * v], t[4 * v + 1], t[4 * v + 2]) == doctest::Approx(1));
    CHECK(t[4 * v] * n[3 * v] + t[4 * v + 1] * n[3 * v + 1] + t[4 * v + 2] * n[3 * v + 2] == doctest::Approx(0));
  }
  CHECK(t[4 + 1] == 1);
  CHECK(std::vector<float>{t[3], t[7], t[11], t[15]} == std::vector<float>{1, -1, 1, -1});
}

TEST_CASE("a vertex' weights sum to 1, and one without any hangs on its first joint") {
  const Asset asset =
      with("WEIGHTS_0", "VEC4", 4, {2, 2, 0, 0, 0, 0, 0, 0, -1, 0.5F, 0, 0, 0.25F, 0.25F, 0.25F, 0.25F});
  CHECK(values_of(asset, "WEIGHTS_0") ==
        std::vector<float>{0.5F, 0.5F, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.25F, 0.25F, 0.25F, 0.25F});
  CHECK(mended(asset).starts_with("3 values of WEIGHTS_0"));
}

TEST_CASE("colours are clamped to what glTF allows") {
  const Asset asset = with("COLOR_0", "VEC3", 3, {2, 0.5F, 0, 1, 1, 1, 0, -0.5F, 0, 0.1F, 0.2F, 0.3F});
  CHECK(values_of(asset, "COLOR_0") == std::vector<float>{1, 0.5F, 0, 1, 1, 1, 0, 0, 0, 0.1F, 0.2F, 0.3F});
  CHECK(mended(asset).starts_with("2 values of COLOR_0"));
}

TEST_CASE("morph targets lose what is no number") {
  GltfBuilder b = test::tetrahedron();
  const auto offset = b.add_accessor(std::vector<float>{no_number, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
  b.json["meshes"][0]["primitives"][0]["targets"] = test::Json::array({test::Json{{"POSITION", offset}}});
  const Asset asset = read_asset(b.glb(), {}, {});
  CHECK(asset.primitives[0].targets.at(0).at(0).get(0, 0) == 0);
  CHECK(asset.primitives[0].targets.at(0).at(0).get(0, 1) == 1);
  CHECK(mended(asset).ends_with("/meshes/0/primitives/0/targets/0/POSITION"));
}
