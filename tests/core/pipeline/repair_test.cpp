// Whatever has triangles comes back: the same triangles, each whole, on certified spheres.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/asset/asset.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/glb_of_mesh.h"

using namespace orbis;

namespace {

// Every triangle with vertices of its own that carry its number, so that its pieces can be told in the result.
std::vector<std::byte> numbered_glb_of(const mesh::TriangleMesh& m) {
  GlbOfMesh glb;
  const mesh::TriangleMesh soup = shapes::soup(m);
  std::vector<float> number;
  for (std::size_t v = 0; v < soup.positions.size(); ++v) number.push_back(static_cast<float>(v / 3));
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(soup.positions);
  attributes["_NUMBER"] = glb.add(number, 5126, "SCALAR", number.size());
  const std::size_t indices = glb.add_indices(soup.triangles);
  glb.document()["meshes"] = one_primitive(attributes, indices);
  one_node(glb.document());
  return glb.bytes();
}

Result run(const std::vector<std::byte>& glb, const Options& options = {}) {
  NoProgress progress;
  Request request{glb, {}, options};
  request.options.texture_size = 512;
  return process(request, {}, progress);
}

double area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return norm(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a))) / 2;
}

// The pieces of each triangle make up its area, and there is at least one.
void check_same_triangles(const mesh::TriangleMesh& input, const std::vector<std::byte>& glb) {
  const asset::Asset file = asset::read_asset(glb, {}, {});
  REQUIRE(file.primitives.size() == 1);
  const asset::Primitive& p = file.primitives[0];
  const std::vector<Vec3f> positions = p.positions();
  const asset::Attribute& number = *p.find("_NUMBER");
  std::vector<double> sum(input.triangles.size(), 0);
  std::vector<int> pieces(input.triangles.size(), 0);
  for (std::size_t i = 0; i < p.indices.size(); i += 3) {
    const auto t = static_cast<std::size_t>(std::lround(number.get(p.indices[i], 0)));
    REQUIRE(t < sum.size());
    CHECK(std::lround(number.get(p.indices[i + 1], 0)) == static_cast<long>(t));
    CHECK(std::lround(number.get(p.indices[i + 2], 0)) == static_cast<long>(t));
    sum[t] += area(positions[p.indices[i]], positions[p.indices[i + 1]], positions[p.indices[i + 2]]);
    ++pieces[t];
  }
  for (std::size_t t = 0; t < sum.size(); ++t) {
    const auto& [i, j, k] = input.triangles[t];
    const double wanted = area(input.positions[i], input.positions[j], input.positions[k]);
    CHECK(pieces[t] > 0);
    CHECK(std::abs(sum[t] - wanted) < 1e-5 * wanted + 1e-7);
  }
}

Result returned(const mesh::TriangleMesh& m, const Options& options = {}) {
  const Result result = run(numbered_glb_of(m), options);
  CHECK(result.report.certificate.valid);
  CHECK(result.report.cut_certificate.valid);
  CHECK_FALSE(result.report.partial);
  for (const ComponentReport& c : result.report.components) CHECK(c.certified);
  check_same_triangles(m, result.glb);
  return result;
}

Options with(std::string_view name, std::string_view value) {
  Options options;
  set_option(options, name, value);
  return options;
}

std::vector<std::byte> file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

} // namespace

TEST_CASE("open surfaces come back as they are, without their caps") {
  const mesh::TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const mesh::TriangleMesh& m :
       {triangle, shapes::terrain(1, 1), shapes::disk(4, 16), shapes::annulus(3, 12), shapes::terrain(12, 8, 0.8F),
        shapes::holed_terrain(9, 7), shapes::strip(30, 2, 0)}) {
    const Result result = returned(m);
    REQUIRE(result.report.components.size() == 1);
    CHECK(result.report.components[0].cap_triangles > 0);
    CHECK(result.report.repairs.capped_loops == result.report.components[0].boundary_loops);
  }
}

TEST_CASE("a flat disk takes about half of its sphere, nearly without distortion") {
  const Result result = returned(shapes::disk(12, 36));
  CHECK(result.report.distortion.symmetric_dirichlet < 1.15);
}

TEST_CASE("handles are cut, and the cut is in the report") {
  for (const mesh::TriangleMesh& m : {shapes::torus(16, 8), shapes::plate_with_holes(3)}) {
    const Result result = returned(m);
    CHECK(result.report.repairs.handles == result.report.components[0].genus);
    CHECK(result.report.repairs.handle_cut_length > 0);
    CHECK(result.report.repairs.capped_loops == 2 * result.report.repairs.handles);
  }
}

TEST_CASE("one-sided surfaces and sheets that touch come back whole") {
  CHECK(returned(shapes::strip(40, 2, 1)).report.repairs.one_sided_edges > 0);
  CHECK(returned(shapes::klein_bottle(20, 12)).report.repairs.one_sided_edges > 0);
  CHECK(returned(shapes::voxels({{0, 0, 0}, {1, 1, 0}})).report.components.size() == 2);
  CHECK(returned(shapes::voxels({{0, 0, 0}, {1, 1, 1}})).report.components.size() == 2);
  CHECK(returned(shapes::t_junction_grid(5)).report.components.size() == 1);
}

TEST_CASE("triangles without area and duplicates are delivered, but not certified a second time") {
  mesh::TriangleMesh m = shapes::bumpy_sphere(2);
  const std::size_t whole = m.triangles.size();
  for (const std::size_t t : {3U, 17U, 17U}) m.triangles.push_back(m.triangles[t]);
  m.triangles.push_back({1, 1, 2});
  m.triangles.push_back({4, 4, 4});
  const Result result = returned(m);
  CHECK(result.report.repairs.duplicate_triangles == 3);
  CHECK(result.report.repairs.degenerate_triangles == 2);
  CHECK(result.report.certificate.triangles == whole);
}

TEST_CASE("a duplicate of another material is a surface of its own, one of the same material is not") {
  const auto glb_with = [](const char* materials) {
    GlbOfMesh glb;
    nlohmann::json attributes;
    const mesh::TriangleMesh m = shapes::terrain(3, 2, 1);
    attributes["POSITION"] = glb.add_positions(m.positions);
    const std::size_t indices = glb.add_indices(m.triangles);
    glb.document()["materials"] = nlohmann::json::parse("[{}, {}]");
    glb.document()["meshes"] = one_primitive(attributes, indices);
    nlohmann::json& primitives = glb.document()["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    for (std::size_t i = 0; i < 2; ++i) primitives[i]["material"] = materials[i] - '0';
    one_node(glb.document());
    return glb.bytes();
  };
  const Result different = run(glb_with("01")), same = run(glb_with("00"));
  CHECK(different.report.components.size() == 2);
  CHECK(different.report.repairs.duplicate_triangles == 0);
  CHECK(same.report.components.size() == 1);
  CHECK(same.report.repairs.duplicate_triangles == shapes::terrain(3, 2).triangles.size());
  const asset::Asset out = asset::read_asset(same.glb, {}, {});
  REQUIRE(out.primitives.size() == 2);
  CHECK(out.primitives[0].indices.size() == out.primitives[1].indices.size());
  CHECK(out.primitives[1].find("_SPHERE") != nullptr);
}

TEST_CASE("a component without extent is told, and the rest comes back") {
  // By its indices a tetrahedron, but all in one place.
  mesh::TriangleMesh m = shapes::bumpy_sphere(2);
  mesh::TriangleMesh point = shapes::tetrahedron();
  for (Vec3f& p : point.positions) p = {7, 7, 7};
  const std::vector<std::byte> glb = glb_of(shapes::joined(m, point));
  const Result result = run(glb);
  CHECK(result.report.partial);
  REQUIRE(result.report.components.size() == 2);
  CHECK_FALSE(result.report.components[0].problem.has_value());
  REQUIRE(result.report.components[1].problem.has_value());
  CHECK(result.report.components[1].problem->code == "no-extent");
  // The primitive goes on as two: what has a place on a sphere, and what has none.
  const asset::Asset out = asset::read_asset(result.glb, {}, {});
  REQUIRE(out.primitives.size() == 2);
  CHECK(out.primitives[0].find("_SPHERE") != nullptr);
  CHECK(out.primitives[1].find("_SPHERE") == nullptr);
  CHECK(out.primitives[1].indices == asset::read_asset(glb_of(point), {}, {}).primitives[0].indices);
  for (const Vec3f& p : out.primitives[1].positions()) CHECK(p == Vec3f{7, 7, 7});
  CHECK(result.report.output_triangles >= result.report.input_triangles);
}

TEST_CASE("what is left out keeps its material, its texture coordinates and its morph targets") {
  // Its vertices came back as part of the material's atlas once, all of one texel's colour.
  GlbOfMesh glb;
  mesh::TriangleMesh point = shapes::tetrahedron();
  for (Vec3f& p : point.positions) p = {7, 7, 7};
  const mesh::TriangleMesh m = shapes::joined(shapes::bumpy_sphere(1), point);
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(m.positions);
  attributes["_TEMPERATURE"] = glb.add_positions(m.positions);
  glb.document()["materials"] = nlohmann::json::parse(R"([{"name": "skin", "doubleSided": true}])");
  glb.document()["meshes"] = one_primitive(attributes, glb.add_indices(m.triangles));
  nlohmann::json& primitive = glb.document()["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["targets"] = nlohmann::json::array({{{"POSITION", glb.add_positions(m.positions)}}});
  one_node(glb.document());
  const Result result = run(glb.bytes());

  const asset::Asset out = asset::read_asset(result.glb, {}, {});
  REQUIRE(out.primitives.size() == 2);
  const asset::Primitive& left_out = out.primitives[1];
  REQUIRE(left_out.vertex_count() == 4);
  REQUIRE(left_out.targets.size() == 1);
  CHECK(left_out.targets[0].at(0).count() == 4);
  const asset::Attribute* temperature = left_out.find("_TEMPERATURE");
  REQUIRE(temperature != nullptr);
  CHECK(temperature->get(3, 2) == 7);
  CHECK(out.primitives[0].material != left_out.material);
  CHECK(left_out.material.has_value());
  CHECK_FALSE(asset::names_texture(out, left_out, asset::TextureSlot::base_color));
  CHECK(asset::names_texture(out, out.primitives[0], asset::TextureSlot::base_color));
}

TEST_CASE("topology=strict refuses what would have to be repaired, and takes what would not") {
  CHECK_THROWS_WITH_AS(static_cast<void>(run(glb_of(shapes::torus(10, 6)), with("topology", "strict"))),
                       doctest::Contains("genus 1"), Error);
  CHECK_THROWS_WITH_AS(static_cast<void>(run(glb_of(shapes::disk(2, 7)), with("topology", "strict"))),
                       doctest::Contains("1 boundary loop"), Error);
  CHECK(run(glb_of(shapes::bumpy_sphere(2)), with("topology", "strict")).report.certificate.valid);
}

TEST_CASE("vertices within the tolerance are one, and keep their positions") {
  mesh::TriangleMesh m = shapes::soup(shapes::bumpy_sphere(3));
  for (std::size_t v = 0; v < m.positions.size(); ++v) m.positions[v].x += 1e-5F * static_cast<float>(v % 3);
  CHECK(returned(m).report.components.size() == m.triangles.size());
  const Result joined = returned(m, with("weld_tolerance", "0.0001"));
  CHECK(joined.report.components.size() == 1);
  CHECK(joined.report.repairs.capped_loops == 0);
}

TEST_CASE("the same scene gives the same bytes with any number of threads") {
  mesh::TriangleMesh m = shapes::joined(shapes::torus(20, 9), shapes::moved(shapes::holed_terrain(9, 9), {20, 0, 0}));
  for (int i = 0; i < 20; ++i)
    m = shapes::joined(m, shapes::moved(shapes::sphere(1), {0, 3.0F * static_cast<float>(i), 30}));
  const std::vector<std::byte> glb = glb_of(m);
  CHECK(run(glb, with("threads", "1")).glb == run(glb, with("threads", "4")).glb);
}

TEST_CASE("every open, many-handled, many-part and non-manifold file that is at hand comes back certified") {
  const std::filesystem::path data = ORBIS_SHARED_DATA;
  if (!std::filesystem::exists(data)) {
    MESSAGE("no shared data beside the project: not tested");
    return;
  }
  for (const char* name :
       {"genus/torus-g1.glb", "genus/skull-g2.glb", "genus/stoneLantern-g7.glb", "multi/character.glb",
        "nonmanifold/double_sided.glb", "nonmanifold/hourglass.glb", "nonmanifold/test_nm.drc",
        "nonmanifold/floor_wood_large.glb", "open/Triangle.gltf", "open/hand-1loop.glb", "made/cat-duplicate-faces.glb",
        "made/cat-mixed-orientation.glb", "made/cat-plus-speck.glb"}) {
    CAPTURE(name);
    const Result result = run(file(data / name));
    CHECK(result.report.certificate.valid);
    CHECK_FALSE(result.report.partial);
  }
}
