// Survey coordinates: float32 has steps of half a metre at 4.6 million, in which a building is no building any more.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "core/asset/extent.h"
#include "support/unchanged.h"

using namespace orbis;
using namespace orbis::asset;
using test::bytes_of;

namespace {

bool has_note(const Asset& asset) {
  return std::any_of(asset.notes.begin(), asset.notes.end(),
                     [](const auto& note) { return note.code == "origin-moved"; });
}

Asset read(std::string_view text) { return read_asset(bytes_of(text), {}, Limits{}); }

// Where vertex v of a primitive lies, in double precision, by its node.
Vec3d place_of(const Asset& asset, std::size_t primitive, std::size_t v) {
  const Primitive& p = asset.primitives.at(primitive);
  Vec3d out = vector_at(*p.find("POSITION"), v);
  const Json* translation = find(asset.document->json["nodes"][p.mesh], "translation");
  if (translation != nullptr) {
    out += {translation->at(0).get<double>(), translation->at(1).get<double>(), translation->at(2).get<double>()};
  }
  return out;
}

bool is_near(const Vec3d& a, const Vec3d& b) { return norm(a - b) < 1e-6; }

constexpr std::string_view ply_header =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n";

} // namespace

TEST_CASE("OBJ: what lies far away keeps its shape, and its place by the nodes' translation") {
  const Asset asset = read("o a\nv 500000.1 4649776.2 10.3\nv 500001.1 4649776.2 10.3\nv 500001.1 4649777.2 10.3\n"
                           "v 500000.1 4649777.2 10.3\nf 1 2 3 4\n"
                           "o b\nv 500010.7 4649776.2 11.3\nv 500011.7 4649776.2 11.3\nf -2 -1 1\n");
  CHECK(has_note(asset));
  CHECK(is_near(place_of(asset, 0, 0), {500000.1, 4649776.2, 10.3}));
  CHECK(is_near(place_of(asset, 0, 2), {500001.1, 4649777.2, 10.3}));
  CHECK(is_near(place_of(asset, 1, 0), {500010.7, 4649776.2, 11.3}));
  const Json& nodes = asset.document->json["nodes"];
  CHECK(nodes[0]["translation"] == nodes[1]["translation"]);
  CHECK(nodes[0]["translation"][2] == 0.0); // heights are not far
  for (const Json& x : nodes[0]["translation"]) CHECK(double{x.get<float>()} == x.get<double>());
  CHECK_NOTHROW(test::write_unchanged(asset));
}

TEST_CASE("the note of a moved origin has the coordinates as a surveyor writes them") {
  const Asset asset = read("v 400000.1 5200000.3 1.5\nv 399999.9 5200000.3 1.5\nv 400000.1 5199999.7 1.5\nf 1 2 3\n");
  REQUIRE(has_note(asset));
  CHECK(asset.notes.front().message.find("(400000, 5200000, 0)") != std::string::npos);
}

TEST_CASE("OBJ: a polygon far away is divided by its shape, not by what float32 leaves of it") {
  // An arrow whose notch is smaller than float32's steps there; cut the wrong way, a triangle lies upside down.
  const Asset asset = read("v 500000 4649776 0\nv 500000.3 4649776 0\nv 500000.1 4649776.1 0\nv 500000 4649776.3 0\n"
                           "f 1 2 3 4\n");
  const Primitive& p = asset.primitives.at(0);
  const std::vector<Vec3f> x = p.positions();
  for (std::size_t t = 0; t < p.indices.size(); t += 3) {
    const Vec3f& a = x[p.indices[t]];
    CHECK(cross(x[p.indices[t + 1]] - a, x[p.indices[t + 2]] - a).z > 0);
  }
}

TEST_CASE("PLY: doubles far away are moved, too; floats have nothing to gain and stay") {
  const std::string rows = "4649776.1 500000.1 10.3\n4649777.1 500000.1 10.3\n4649777.1 500001.1 10.3\n"
                           "4649776.1 500001.1 10.3\n4 0 1 2 3\n";
  const Asset asset = read(std::string(ply_header) + rows);
  CHECK(has_note(asset));
  CHECK(is_near(place_of(asset, 0, 2), {4649777.1, 500001.1, 10.3}));
  const Asset exact = read(std::string(ply_header) + "4649776 500000.5 0\n4649777 500000.5 0\n4649777 500001 0\n"
                                                     "4649776 500001 0\n4 0 1 2 3\n");
  CHECK_FALSE(has_note(exact));
  CHECK(exact.primitives.at(0).positions().at(0) == Vec3f(4649776.0F, 500000.5F, 0.0F));
}

TEST_CASE("OBJ: a model that is not far away comes out in the float32 numbers nearest to the text") {
  // The third one is nearest to 1 + 2^-23, but the double nearest to it lies midway to 1, which is even.
  const Asset asset = read("v 0.1 -0 16777217\nv 1e-42 1e-60 3.3333333333333333\n"
                           "v 1.00000005960464477540 1.17549435e-38 -7.7\nf 1 2 3\n");
  CHECK_FALSE(has_note(asset));
  CHECK_FALSE(asset.document->json["nodes"][0].contains("translation"));
  const std::vector<Vec3f> p = asset.primitives.at(0).positions();
  CHECK(p.at(0).x == 0.1F);
  CHECK(std::signbit(p.at(0).y));
  CHECK(p.at(0).z == 16777216.0F);
  CHECK(p.at(1) == Vec3f(1e-42F, 0.0F, 3.3333333333333333F));
  CHECK(std::bit_cast<std::uint32_t>(p.at(2).x) == 0x3f800001);
  CHECK(p.at(2).y == 1.17549435e-38F);
}

TEST_CASE("an extent is far where its farthest coordinate is more than 256 diagonals away, and only then moves") {
  const auto origin_at = [](double x) {
    Extent extent;
    extent.add({x, 0, 0});
    extent.add({x + 1, 0, 0.1});
    return extent.origin();
  };
  CHECK(origin_at(250.3) == Vec3d());
  CHECK(origin_at(270.3).x == double{270.8F});
  CHECK(origin_at(-270.3).x == double{-269.8F});
  CHECK(origin_at(270.0) == Vec3d()); // float32 has it all
  CHECK(origin_at(std::numeric_limits<double>::infinity()) == Vec3d());
  CHECK(origin_at(std::nan("")) == Vec3d());
  CHECK(Extent().origin() == Vec3d());
}
