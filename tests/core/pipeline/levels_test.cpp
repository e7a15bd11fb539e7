// Levels of detail from the front door: what is in the file, and that it is what the report says.
#include <doctest/doctest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "core/asset/asset.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/glb_of_mesh.h"

using namespace orbis;
using Json = nlohmann::json;

namespace {

Result run(const std::vector<std::byte>& glb, std::string_view lods, std::string_view threads = "0") {
  NoProgress progress;
  Request request{glb, {}, {}};
  request.options.texture_size = 256;
  set_option(request.options, "lods", lods);
  set_option(request.options, "threads", threads);
  return process(request, {}, progress);
}

Json json_of(const std::vector<std::byte>& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  return Json::parse(std::string_view(reinterpret_cast<const char*>(glb.data()) + 20, length));
}

asset::Asset read(const std::vector<std::byte>& glb) { return asset::read_asset(glb, {}, {}); }

// The same model under another document: `change` patches its JSON.
template <class Change> std::vector<std::byte> patched(const std::vector<std::byte>& glb, Change change) {
  Json json = json_of(glb);
  change(json);
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  std::string text = json.dump();
  while (text.size() % 4 != 0) text += ' ';
  std::vector<std::byte> out(glb.begin(), glb.begin() + 12);
  const auto word = [&](std::uint32_t w) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(w >> (8 * i)));
  };
  word(static_cast<std::uint32_t>(text.size()));
  word(0x4E4F534A);
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
  out.insert(out.end(), glb.begin() + 20 + length, glb.end());
  const auto total = static_cast<std::uint32_t>(out.size());
  std::memcpy(out.data() + 8, &total, sizeof total);
  return out;
}

// The members of a zip archive that are stored as they are, by their local headers (APPNOTE 4.3.7).
std::map<std::string, std::vector<std::byte>> stored_members(const std::vector<std::byte>& zip) {
  std::map<std::string, std::vector<std::byte>> out;
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::size_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8 | std::to_integer<std::size_t>(zip.at(at + i));
    return value;
  };
  for (std::size_t at = 0; number(at, 4) == 0x04034B50;) {
    CHECK(number(at + 8, 2) == 0); // stored
    const std::size_t size = number(at + 18, 4), name = number(at + 26, 2), extra = number(at + 28, 2);
    const auto first = zip.begin() + static_cast<std::ptrdiff_t>(at + 30 + name + extra);
    out[std::string(reinterpret_cast<const char*>(&zip[at + 30]), name)] = {first,
                                                                            first + static_cast<std::ptrdiff_t>(size)};
    at += 30 + name + extra + size;
    if ((number(at, 4)) == 0x08074B50) at += 16; // a data descriptor
  }
  return out;
}

} // namespace

// The levels' proof had counted the file's primitives by the input's, and taken the second mesh for a level.
TEST_CASE("a component that is left out of one mesh does not hide the levels of the others") {
  mesh::TriangleMesh point = shapes::tetrahedron();
  for (Vec3f& p : point.positions) p = {7, 7, 7};
  const std::vector<std::byte> glb = patched(glb_of(shapes::joined(shapes::bumpy_sphere(3), point)), [](Json& json) {
    json["meshes"].push_back(Json(json["meshes"][0]));
    json["nodes"] = Json::parse(R"([{"mesh": 0}, {"mesh": 1}])");
    json["scenes"][0]["nodes"] = {0, 1};
  });
  const Result result = run(glb, "0.3");
  CHECK(result.report.partial);
  REQUIRE(result.report.levels.size() == 1);
  CHECK(result.report.levels[0].degree == doctest::Approx(1));
}

TEST_CASE("levels of detail are alternatives of the node, share its material, and are what the report says") {
  const Result result = run(glb_of(shapes::bumpy_sphere(4)), "0.5,0.1,60");
  const Json json = json_of(result.glb);
  CHECK(json["extensionsUsed"] == Json::array({"MSFT_lod"}));
  CHECK_FALSE(json.contains("extensionsRequired"));
  const Json ids = json["nodes"][0]["extensions"]["MSFT_lod"]["ids"];
  REQUIRE(ids.size() == 3);
  const Json coverage = json["nodes"][0]["extras"]["MSFT_screencoverage"];
  REQUIRE(coverage.size() == 4);
  CHECK(std::is_sorted(coverage.rbegin(), coverage.rend()));
  CHECK(json["scenes"][0]["nodes"] == Json::array({0}));

  const asset::Asset file = read(result.glb);
  REQUIRE(file.primitives.size() == 4);
  REQUIRE(result.report.levels.size() == 3);
  const std::uint64_t all = 2048;
  const std::array<std::uint64_t, 3> most{all / 2, all / 10, 60};
  for (std::size_t i = 0; i < 3; ++i) {
    const Report::Level& level = result.report.levels[i];
    const asset::Primitive& p = file.primitives[i + 1];
    CHECK(json["nodes"][ids[i].get<std::size_t>()]["mesh"] == p.mesh);
    CHECK(level.triangles == p.indices.size() / 3);
    CHECK(level.vertices == p.vertex_count());
    CHECK(level.triangles <= most[i]);
    CHECK(level.reached);
    CHECK(level.folded == 0);
    CHECK(level.psnr > 12);
    CHECK(level.outside == 0);
    CHECK(level.degree == doctest::Approx(1));
    CHECK(p.material == file.primitives[1].material); // the full surface's but for the normal map
    REQUIRE(p.find("_SPHERE") != nullptr);
    REQUIRE(p.find("TEXCOORD_0") != nullptr);
  }
  CHECK(result.report.levels[0].texture_deviation < result.report.levels[2].texture_deviation);
  CHECK(result.report.levels[0].mean_distance < result.report.levels[2].mean_distance);
}

TEST_CASE(
    "the likeness of a level is that of its delivered normal map, on which all levels can be told from bare ones") {
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(5));
  const Report mapped = run(glb, "0.3,0.05").report;
  NoProgress progress;
  Request request{glb, {}, {}};
  set_option(request.options, "texture_size", "256");
  set_option(request.options, "lods", "0.3,0.05");
  set_option(request.options, "maps", "base_color");
  const Report bare = process(request, {}, progress).report;
  REQUIRE(mapped.levels.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) CHECK(mapped.levels[i].psnr > bare.levels[i].psnr + 2);
  CHECK(mapped.levels[0].psnr > mapped.levels[1].psnr);
}

TEST_CASE("without levels the document has none") {
  const Result result = run(glb_of(shapes::bumpy_sphere(3)), "");
  CHECK(result.report.levels.empty());
  CHECK_FALSE(json_of(result.glb).contains("extensionsUsed"));
}

TEST_CASE("levels do not depend on the number of threads") {
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(4));
  CHECK(run(glb, "0.2", "1").glb == run(glb, "0.2", "3").glb);
}

TEST_CASE("skins stay bound on every level") {
  const Result result = run(skinned_glb_of(shapes::bumpy_sphere(4)), "0.1");
  const asset::Asset file = read(result.glb);
  REQUIRE(file.primitives.size() == 2);
  const asset::Primitive& level = file.primitives[1];
  const asset::Attribute *joints = level.find("JOINTS_0"), *weights = level.find("WEIGHTS_0");
  REQUIRE(joints != nullptr);
  REQUIRE(weights != nullptr);
  for (std::size_t v = 0; v < level.vertex_count(); ++v) {
    double sum = 0;
    for (std::uint32_t c = 0; c < 4; ++c) {
      sum += weights->get(v, c);
      CHECK(joints->get(v, c) < 5);
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
  }
  const Json json = json_of(result.glb);
  const auto id = json["nodes"][0]["extensions"]["MSFT_lod"]["ids"][0].get<std::size_t>();
  CHECK(json["nodes"][id]["skin"] == 0);
}

TEST_CASE("morph targets come along, and their animation drives the levels") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(4);
  GlbOfMesh builder;
  Json attributes;
  attributes["POSITION"] = builder.add_positions(m.positions);
  std::vector<Vec3f> deltas;
  for (const Vec3f& p : m.positions) deltas.push_back({0.5F * p.x, 0, 0});
  const std::size_t target = builder.add_positions(deltas);
  const std::size_t indices = builder.add_indices(m.triangles);
  const std::size_t times = builder.add(std::vector<float>{0, 1}, 5126, "SCALAR", 2);
  const std::size_t values = builder.add(std::vector<float>{0, 1}, 5126, "SCALAR", 2);
  Json& json = builder.document();
  json["accessors"][times]["min"] = {0};
  json["accessors"][times]["max"] = {1};
  json["meshes"] = one_primitive(attributes, indices);
  json["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", target}}});
  one_node(json);
  json["animations"] =
      Json::array({{{"samplers", Json::array({{{"input", times}, {"output", values}}})},
                    {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
  const Result result = run(builder.bytes(), "0.1");
  const asset::Asset file = read(result.glb);
  REQUIRE(file.primitives.size() == 2);
  REQUIRE(file.primitives[1].targets.size() == 1);
  // Deltas are linear in the position here, but the level's vertices were fitted: close, not equal.
  const std::vector<Vec3f> at = file.primitives[1].positions();
  for (std::size_t v = 0; v < at.size(); ++v)
    CHECK(file.primitives[1].targets[0][0].get(v, 0) == doctest::Approx(0.5 * double{at[v].x}).epsilon(0.2).scale(0.5));
  const Json out = json_of(result.glb);
  REQUIRE(out["animations"][0]["channels"].size() == 2);
  CHECK(out["animations"][0]["channels"][1]["target"]["node"] == out["nodes"][0]["extensions"]["MSFT_lod"]["ids"][0]);
}

TEST_CASE("where other things hang on a node, its mesh gets a node of its own") {
  const std::vector<std::byte> glb = patched(glb_of(shapes::bumpy_sphere(3)), [](Json& json) {
    json["nodes"] = Json::parse(R"([{"mesh": 0, "translation": [1, 2, 3], "children": [1]}, {"name": "lamp"}])");
  });
  const Json json = json_of(run(glb, "0.2").glb);
  const Json& parent = json["nodes"][0];
  CHECK_FALSE(parent.contains("mesh"));
  CHECK_FALSE(parent.contains("extensions"));
  CHECK(parent["translation"] == Json::array({1, 2, 3}));
  REQUIRE(parent["children"].size() == 2);
  const Json& holder = json["nodes"][parent["children"][1].get<std::size_t>()];
  CHECK(holder["mesh"] == 0);
  CHECK_FALSE(holder.contains("translation"));
  const auto id = holder["extensions"]["MSFT_lod"]["ids"][0].get<std::size_t>();
  CHECK(json["nodes"][id]["mesh"] == 1);
}

TEST_CASE("a node that is only placed keeps its mesh, and each of its levels the place") {
  const std::vector<std::byte> glb = patched(glb_of(shapes::bumpy_sphere(3)), [](Json& json) {
    json["nodes"] = Json::parse(R"([{"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 0, "translation": [9, 0, 0]}])");
    json["scenes"][0]["nodes"] = {0, 1};
  });
  const Json json = json_of(run(glb, "0.5,0.2").glb);
  CHECK(json["meshes"].size() == 3);
  for (const std::size_t n : {0U, 1U}) {
    const Json ids = json["nodes"][n]["extensions"]["MSFT_lod"]["ids"];
    REQUIRE(ids.size() == 2);
    for (std::size_t level = 0; level < 2; ++level) {
      const Json& node = json["nodes"][ids[level].get<std::size_t>()];
      CHECK(node["mesh"] == 1 + level);
      CHECK(node.value("scale", Json()) == json["nodes"][n].value("scale", Json()));
      CHECK(node.value("translation", Json()) == json["nodes"][n].value("translation", Json()));
      CHECK_FALSE(node.contains("extensions"));
    }
  }
}

TEST_CASE("with output=zip every level is a file of its own, named in the manifest") {
  NoProgress progress;
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(4));
  Request request{glb, {}, {}};
  request.options.texture_size = 256;
  set_option(request.options, "lods", "0.2,0.05");
  set_option(request.options, "output", "zip");
  set_option(request.options, "maps", "base_color,normal");
  const Result result = process(request, {}, progress);
  const std::map<std::string, std::vector<std::byte>> files = stored_members(result.glb);
  REQUIRE(files.size() == 4);
  CHECK(read(files.at("model.glb")).primitives.size() == 3);
  const std::vector<std::byte>& text = files.at("manifest.json");
  const Json manifest = Json::parse(std::string_view(reinterpret_cast<const char*>(text.data()), text.size()));
  REQUIRE(manifest["levels"].size() == 2);
  for (const Json& entry : manifest["levels"]) {
    const asset::Asset level = read(files.at(entry["file"].get<std::string>()));
    REQUIRE(level.primitives.size() == 1);
    CHECK(level.primitives[0].indices.size() == 3 * entry["triangles"].get<std::size_t>());
    CHECK(level.primitives[0].vertex_count() == entry["vertices"]);
    CHECK(level.primitives[0].find("_SPHERE") != nullptr);
    for (const asset::TextureSlot slot : {asset::TextureSlot::base_color, asset::TextureSlot::normal})
      CHECK(asset::material_texture(level, level.primitives[0], slot).has_value());
  }
  CHECK(process(request, {}, progress).glb == result.glb);
}

TEST_CASE("a level's own file does not show what the level has lost") {
  mesh::TriangleMesh speck = shapes::tetrahedron();
  for (Vec3f& p : speck.positions) p = {0.002F * p.x + 2, 0.002F * p.y, 0.002F * p.z};
  const mesh::TriangleMesh both = shapes::joined(shapes::bumpy_sphere(3), speck);
  const auto split = both.triangles.end() - static_cast<std::ptrdiff_t>(speck.triangles.size());
  GlbOfMesh glb;
  nlohmann::json attributes, primitives;
  attributes["POSITION"] = glb.add_positions(both.positions);
  primitives = one_primitive(attributes, glb.add_indices({both.triangles.begin(), split}));
  primitives[0]["primitives"].push_back(
      one_primitive(attributes, glb.add_indices({split, both.triangles.end()}))[0]["primitives"][0]);
  glb.document()["meshes"] = primitives;
  one_node(glb.document());
  const std::vector<std::byte> model = glb.bytes();
  NoProgress progress;
  Request request{model, {}, {}};
  request.options.texture_size = 128;
  set_option(request.options, "lods", "0.5,4");
  set_option(request.options, "output", "zip");
  const Result result = process(request, {}, progress);
  REQUIRE(result.report.levels.at(1).lost_components == 1);
  const std::map<std::string, std::vector<std::byte>> files = stored_members(result.glb);
  CHECK(read(files.at("lod1.glb")).primitives.size() == 2);
  const asset::Asset level = read(files.at("lod2.glb"));
  REQUIRE(level.primitives.size() == 1);
  CHECK(level.primitives[0].indices.size() == 3 * result.report.levels[1].triangles);
}

TEST_CASE("on a ragged sheet no vertex of a level flies away") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> chance(0, 1);
    mesh::TriangleMesh sheet = shapes::terrain(40, 40, 2);
    std::erase_if(sheet.triangles, [&](const mesh::Triangle&) { return chance(random) < 0.12; });
    const Report report = run(glb_of(sheet), "0.3").report;
    REQUIRE(report.levels.size() == 1);
    CHECK(report.levels[0].hausdorff_distance < 9);
    CHECK(report.levels[0].texture_deviation_max < 9);
  }
}

TEST_CASE("a bound that the level before has left behind is not reached, and said so") {
  const Report report = run(glb_of(shapes::bumpy_sphere(4)), "100,deviation:0.001").report;
  REQUIRE(report.levels.size() == 2);
  CHECK(report.levels[0].reached);
  CHECK(report.levels[1].triangles == report.levels[0].triangles);
  CHECK_FALSE(report.levels[1].reached);
  CHECK(std::ranges::count(report.notes, "lod-short", &Note::code) == 1);
}

TEST_CASE("the option takes parts, numbers and bounds, from fine to coarse") {
  Options options;
  set_option(options, "lods", "0.5,1000,deviation:0.05,deviation:0.2");
  CHECK(options.lods.size() == 4);
  CHECK(get_option(options, "lods") == "0.5,1000,deviation:0.05,deviation:0.2");
  set_option(options, "lods", "");
  CHECK(options.lods.empty());
  for (const std::string_view bad :
       {"0", "-1", "0.1,0.2", "100,200", "deviation:0.2,deviation:0.1", "2.5", "x", "0.5,,0.1", "0.5,", ",0.5", ",",
        "deviation:", "3", "0.9,0.8,0.7,0.6,0.5,0.4,0.3,0.2,0.1"}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(set_option(options, "lods", bad), Error);
  }
}
