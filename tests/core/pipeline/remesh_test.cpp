// A remesh from the front door: regular, proved, close to the input, with the input's colours.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/glb_of_mesh.h"

using namespace orbis;

namespace {

Result run(const std::vector<std::byte>& glb, std::string_view target,
           const std::vector<std::pair<std::string, std::string>>& more = {}) {
  NoProgress progress;
  Request request{glb, {}, {}};
  request.options.texture_size = 256;
  set_option(request.options, "remesh", target);
  for (const auto& [name, value] : more) set_option(request.options, name, value);
  return process(request, {}, progress);
}

asset::Primitive primitive_of(const Result& result) { return asset::read_asset(result.glb, {}, {}).primitives.at(0); }

std::string document_of(const Result& result) {
  const auto text = asset::split_glb(result.glb).json;
  return {reinterpret_cast<const char*>(text.data()), text.size()};
}

bool has_note(const Result& result, std::string_view code) {
  return std::ranges::any_of(result.report.notes, [&](const Note& n) { return n.code == code; });
}

// Vertices by their point on the sphere: the remesh before the atlas cut it.
std::map<std::array<double, 3>, std::set<std::array<double, 3>>> positions_by_sphere(const asset::Primitive& p) {
  const asset::Attribute &sphere = *p.find("_SPHERE"), &position = *p.find("POSITION");
  std::map<std::array<double, 3>, std::set<std::array<double, 3>>> out;
  for (std::size_t v = 0; v < sphere.count(); ++v) {
    out[{sphere.get(v, 0), sphere.get(v, 1), sphere.get(v, 2)}].insert(
        {position.get(v, 0), position.get(v, 1), position.get(v, 2)});
  }
  return out;
}

// A sphere whose vertices are coloured by where they are.
std::vector<std::byte> coloured_sphere() {
  const mesh::TriangleMesh m = shapes::sphere(5);
  GlbOfMesh glb;
  std::vector<Vec3f> colors;
  for (const Vec3f& p : m.positions) colors.push_back({0.5F + 0.5F * p.x, 0.5F + 0.5F * p.y, 0.5F + 0.5F * p.z});
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(m.positions);
  attributes["COLOR_0"] = glb.add(colors, 5126, "VEC3", colors.size());
  glb.document()["meshes"] = one_primitive(attributes, glb.add_indices(m.triangles));
  one_node(glb.document());
  return glb.bytes();
}

} // namespace

TEST_CASE("a remesh has the polyhedron's triangles, is certified, and lies on the input") {
  const Result result = run(glb_of(shapes::bumpy_sphere(5)), "icosahedral:4");
  const Report& report = result.report;
  REQUIRE(report.remesh);
  CHECK(report.remesh->components == 1);
  CHECK(report.remesh->kept_components == 0);
  CHECK(report.remesh->triangles == 20 * 256);
  CHECK(report.remesh->vertices == 10 * 256 + 2);
  CHECK(report.certificate.valid);
  CHECK(report.certificate.triangles == 20 * 256);
  CHECK(report.cut_certificate.valid);
  CHECK(report.atlas_certificate.valid);
  CHECK(report.components.at(0).remesh_triangles == 20 * 256);
  CHECK(report.remesh->mean_distance < 0.1);
  CHECK(report.remesh->mean_distance_from_input < 0.1);
  CHECK(report.remesh->hausdorff_distance >= report.remesh->mean_distance);
  CHECK(report.remesh->hausdorff_distance < 2);
  const auto points = positions_by_sphere(primitive_of(result));
  CHECK(points.size() >= 10 * 256 + 2);
  for (const auto& [sphere, positions] : points) CHECK(positions.size() == 1); // no gap along the atlas' cuts
}

TEST_CASE("more divisions come closer") {
  double before = 100;
  for (const char* target : {"octahedral:2", "octahedral:3", "octahedral:4"}) {
    const Result result = run(glb_of(shapes::bumpy_sphere(4)), target);
    REQUIRE(result.report.remesh);
    CHECK(result.report.remesh->mean_distance_from_input < before);
    before = result.report.remesh->mean_distance_from_input;
  }
}

TEST_CASE("the maps of a remesh show the input's colours at the places that they had there") {
  // Coarser than the input, so that vertices alone would not know them.
  const Result result = run(coloured_sphere(), "icosahedral:2", {{"maps", "base_color,position"}});
  const auto found = std::ranges::find(result.maps, "base_color.png", &MapFile::name);
  const auto place = std::ranges::find(result.maps, "position.png", &MapFile::name);
  REQUIRE(found != result.maps.end());
  REQUIRE(place != result.maps.end());
  const texture::Image color = asset::decode_image(found->bytes, 1 << 24, "");
  const texture::Image position = asset::decode_image(place->bytes, 1 << 24, "");
  REQUIRE(color.pixels.size() == position.pixels.size());
  // On the sphere a linear colour of 0.5 + 0.5 x is, after the box of the position map, the position itself.
  int worst = 0;
  for (std::size_t i = 0; i < color.pixels.size(); ++i) {
    const double linear = position.pixels[i] / 255.0;
    const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    if (linear > 0.05) worst = std::max(worst, std::abs(static_cast<int>(std::lround(255 * srgb)) - color.pixels[i]));
  }
  CHECK(worst <= 4);
}

TEST_CASE("a component with holes keeps its triangles beside one that is remeshed, and a small one gets few") {
  const mesh::TriangleMesh open = shapes::moved(shapes::disk(4, 8), {5, 0, 0});
  const mesh::TriangleMesh small = shapes::moved(shapes::sphere(4), {40, 0, 0});
  mesh::TriangleMesh large = shapes::bumpy_sphere(4);
  for (Vec3f& p : large.positions) p = p * 8.0F;
  const Result result = run(glb_of(shapes::joined(shapes::joined(large, small), open)), "octahedral:4");
  const Report& report = result.report;
  REQUIRE(report.remesh);
  CHECK(report.remesh->components == 2);
  CHECK(report.remesh->kept_components == 1);
  CHECK(report.remesh->triangles == 8 * 256 + 8 * 4);
  CHECK(has_note(result, "remesh-kept"));
  CHECK(report.certificate.valid);
  CHECK(report.output_triangles >= 8 * 256 + 8 * 4 + open.triangles.size());
  // The open one's vertices are there to the bit.
  std::set<std::array<double, 3>> delivered;
  const asset::Primitive p = primitive_of(result);
  const asset::Attribute& position = *p.find("POSITION");
  for (std::size_t v = 0; v < position.count(); ++v)
    delivered.insert({position.get(v, 0), position.get(v, 1), position.get(v, 2)});
  for (const Vec3f& q : open.positions) CHECK(delivered.contains({q.x, q.y, q.z}));
}

TEST_CASE("skins come along, and levels of detail and normal maps can be made of a remesh") {
  const Result skinned =
      run(skinned_glb_of(shapes::bumpy_sphere(4)), "icosahedral:3", {{"lods", "0.25"}, {"maps", "all"}});
  CHECK(skinned.report.certificate.valid);
  CHECK(skinned.report.levels.size() == 1);
  const asset::Primitive p = primitive_of(skinned);
  REQUIRE(p.find("WEIGHTS_0") != nullptr);
  REQUIRE(p.find("TANGENT") != nullptr);
  for (std::size_t v = 0; v < p.vertex_count(); ++v) {
    double sum = 0;
    for (std::uint32_t c = 0; c < 4; ++c) sum += p.find("WEIGHTS_0")->get(v, c);
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
  }
}

TEST_CASE("a remesh has the input's shading in a normal map, unless the maps are named without one") {
  const std::vector<std::byte> input = glb_of(shapes::bumpy_sphere(3));
  CHECK(document_of(run(input, "octahedral:3")).find("normalTexture") != std::string::npos);
  CHECK(document_of(run(input, "octahedral:3", {{"maps", "base_color"}})).find("normalTexture") == std::string::npos);
}

TEST_CASE("what cannot be remeshed is refused with its reason, and the same job gives the same bytes") {
  CHECK_THROWS_AS(run(glb_of(shapes::disk(4, 8)), "octahedral:3"), Error);
  CHECK_THROWS_AS(run(glb_of(shapes::torus(12, 8)), "octahedral:3"), Error);
  const auto glb = glb_of(shapes::bumpy_sphere(4));
  CHECK(run(glb, "octahedral:3", {{"threads", "1"}}).glb == run(glb, "octahedral:3", {{"threads", "3"}}).glb);
}

TEST_CASE("targets of a remesh are read and written; others are refused") {
  Options options;
  for (const char* text : {"none", "octahedral:1", "icosahedral:8"}) {
    set_option(options, "remesh", text);
    CHECK(get_option(options, "remesh") == text);
  }
  for (const char* bad : {"", "icosahedral", "octahedral:0", "octahedral:9", "cube:2", "octahedral:2x", "none:1"})
    CHECK_THROWS_AS(set_option(options, "remesh", bad), Error);
}
