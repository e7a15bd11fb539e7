// What is baked, and that the result shows it rightly: no texture on wrong coordinates, nothing multiplied twice.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "core/texture/color.h"
#include "core/texture/sampler.h"
#include "support/flat_png.h"
#include "support/glb_of_mesh.h"
#include "support/gltf_builder.h"
#include "support/shapes.h"

using namespace orbis;
using test::flat_png;
using test::GltfBuilder;
using test::Json;

namespace {

// A sphere with normals, texture coordinates by its directions, vertex colours (half the light), and a material with
// every texture, each of one colour of its own.
GltfBuilder painted_sphere() {
  const mesh::TriangleMesh m = shapes::sphere(4);
  std::vector<float> positions, uv, colors;
  std::vector<std::uint32_t> indices;
  for (const Vec3f& p : m.positions) {
    const Vec3f n = normalized(p);
    positions.insert(positions.end(), {n.x, n.y, n.z});
    uv.insert(uv.end(), {0.5F + 0.4F * n.x, 0.5F + 0.4F * n.y});
    colors.insert(colors.end(), {0.5F, 0.5F, 0.5F});
  }
  for (const auto& t : m.triangles) indices.insert(indices.end(), t.begin(), t.end());
  GltfBuilder b;
  Json attributes;
  attributes["POSITION"] = b.add_accessor(positions, "VEC3", 3);
  attributes["NORMAL"] = b.add_accessor(positions, "VEC3", 3);
  attributes["TEXCOORD_0"] = b.add_accessor(uv, "VEC2", 2);
  attributes["COLOR_0"] = b.add_accessor(colors, "VEC3", 3);
  const auto index = b.add_accessor(indices, "SCALAR", 1);
  b.add_mesh(Json{{"attributes", attributes}, {"indices", index}, {"material", 0}});
  const auto texture = [&](const test::Bytes& png) {
    const auto image = b.append("images", Json{{"bufferView", b.add_view(png)}, {"mimeType", "image/png"}});
    return Json{{"index", b.append("textures", Json{{"source", image}})}};
  };
  Json material{{"name", "paint"}};
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 0.5, 0.5, 1}},
                                      {"baseColorTexture", texture(flat_png(200, 100, 50))},
                                      {"metallicRoughnessTexture", texture(flat_png(9, 80, 160))}};
  material["occlusionTexture"] = texture(flat_png(120, 7, 7));
  material["emissiveTexture"] = texture(flat_png(10, 20, 30));
  material["normalTexture"] = texture(flat_png(128, 128, 255));
  b.append("materials", material);
  return b;
}

Result run(const GltfBuilder& b, const std::vector<std::pair<std::string, std::string>>& settings) {
  NoProgress progress;
  const test::Bytes glb = b.glb();
  Request request{glb, {}, {}};
  request.options.texture_size = 128;
  for (const auto& [name, value] : settings) set_option(request.options, name, value);
  return process(request, {}, progress);
}

Json json_of(const std::vector<std::byte>& glb) {
  const auto text = asset::split_glb(glb).json;
  return Json::parse(reinterpret_cast<const char*>(text.data()),
                     reinterpret_cast<const char*>(text.data()) + text.size());
}

std::vector<std::string> names_of(const Result& result) {
  std::vector<std::string> names;
  for (const MapFile& map : result.maps) names.push_back(map.name);
  return names;
}

texture::Image map_of(const Result& result, std::string_view name) {
  for (const MapFile& map : result.maps) {
    if (map.name == name) return asset::decode_image(map.bytes, 1 << 24, "");
  }
  FAIL("the map is missing");
  return {};
}

std::array<int, 3> color_in(const texture::Image& image) {
  const std::uint8_t* p = image.at(image.width / 6, image.height / 4); // the middle of a chart, or beside one
  return {p[0], p[1], p[2]};
}

bool has(const Json& json, std::string_view attribute) {
  return json["meshes"][0]["primitives"][0]["attributes"].contains(std::string(attribute));
}

} // namespace

TEST_CASE("every texture of a material moves to the atlas, in an image of its own, with its factors beside it") {
  const Result result = run(painted_sphere(), {});
  CHECK(names_of(result) ==
        std::vector<std::string>{"base_color.png", "occlusion_roughness_metallic.png", "emissive.png", "normal.png"});
  CHECK(color_in(map_of(result, "occlusion_roughness_metallic.png")) == std::array{120, 80, 160});
  CHECK(color_in(map_of(result, "emissive.png")) == std::array{10, 20, 30});
  const Json json = json_of(result.glb);
  const Json& material = json["materials"][0];
  for (const char* slot : {"occlusionTexture", "emissiveTexture", "normalTexture"})
    CHECK(material[slot]["texCoord"] == 1);
  const Json& pbr = material["pbrMetallicRoughness"];
  CHECK(pbr["metallicRoughnessTexture"] == material["occlusionTexture"]);
  CHECK(pbr["baseColorFactor"] == Json{1, 0.5, 0.5, 1});
  CHECK(json["images"].size() == 4);
  CHECK(result.report.maps.size() == 4);
}

TEST_CASE("vertex colours are baked into the base colour and then no longer multiplied") {
  const Result result = run(painted_sphere(), {});
  const std::array<int, 3> seen = color_in(map_of(result, "base_color.png"));
  CHECK(seen == std::array<int, 3>{texture::to_srgb(texture::to_linear(200) / 2),
                                   texture::to_srgb(texture::to_linear(100) / 2),
                                   texture::to_srgb(texture::to_linear(50) / 2)});
  const Json json = json_of(result.glb);
  CHECK_FALSE(has(json, "COLOR_0"));
  CHECK(has(json, "_COLOR_0"));
}

TEST_CASE("a model of vertex colours alone shows them in its atlas") {
  GltfBuilder b = painted_sphere();
  b.json["materials"][0] = Json{{"name", "plain"}};
  const Result result = run(b, {{"maps", "base_color"}});
  CHECK(result.report.atlas.source == "base_color");
  const int half = texture::to_srgb(0.5F);
  CHECK(color_in(map_of(result, "base_color.png")) == std::array{half, half, half});
}

TEST_CASE("a pattern is multiplied by neither the base colour factor nor the vertex colours") {
  const Json json = json_of(run(painted_sphere(), {{"texture", "pattern"}}).glb);
  CHECK_FALSE(json["materials"][0]["pbrMetallicRoughness"].contains("baseColorFactor"));
  CHECK_FALSE(has(json, "COLOR_0"));
}

TEST_CASE("a texture that cannot be read stays: no pattern goes over it, nor over what has none") {
  GltfBuilder b = painted_sphere();
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
      b.append("textures", Json{{"source", b.append("images", Json{{"uri", "elsewhere.png"}})}});
  b.json["meshes"][0]["primitives"][0]["attributes"].erase("COLOR_0");
  const Json before = b.json["materials"][0]["pbrMetallicRoughness"];
  const Result result = run(b, {});
  CHECK(result.report.atlas.source == "none");
  CHECK(std::ranges::count(result.report.notes, "texture-kept", &Note::code) == 1);
  const Json json = json_of(result.glb);
  const Json& after = json["materials"][0]["pbrMetallicRoughness"];
  CHECK(after["baseColorFactor"] == before["baseColorFactor"]);
  CHECK(after["baseColorTexture"].value("texCoord", 0) == 0);
}

TEST_CASE("vertex colours stay where a variant's material needs them") {
  GltfBuilder b = painted_sphere();
  b.append("materials", Json{{"name", "other"}});
  b.json["extensionsUsed"] = {"KHR_materials_variants"};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = Json::array({Json{{"name", "a"}}});
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
      Json::array({Json{{"material", 1}, {"variants", {0}}}});
  const Result result = run(b, {{"maps", "base_color"}});
  CHECK(color_in(map_of(result, "base_color.png")) == std::array{200, 100, 50});
  CHECK(has(json_of(result.glb), "COLOR_0"));
}

TEST_CASE("what is not asked for stays on its own texture coordinates") {
  const GltfBuilder b = painted_sphere();
  const Json json = json_of(run(b, {{"maps", "emissive"}}).glb);
  const Json &material = json["materials"][0], &before = b.json["materials"][0];
  CHECK(material["emissiveTexture"]["texCoord"] == 1);
  for (const char* slot : {"occlusionTexture", "normalTexture"}) CHECK_FALSE(material[slot].contains("texCoord"));
  CHECK_FALSE(material["pbrMetallicRoughness"]["baseColorTexture"].contains("texCoord"));
  CHECK(material["pbrMetallicRoughness"]["baseColorFactor"] == before["pbrMetallicRoughness"]["baseColorFactor"]);
  CHECK(has(json, "COLOR_0"));
  CHECK_FALSE(has(json, "TANGENT"));
}

TEST_CASE("a flat normal map stays flat on the atlas, in frames that the vertices carry") {
  const Result result = run(painted_sphere(), {});
  const texture::Image normals = map_of(result, "normal.png");
  for (std::uint32_t y = 0; y < normals.height; ++y) {
    for (std::uint32_t x = 0; x < normals.width; ++x) {
      const std::uint8_t* p = normals.at(x, y);
      CHECK(std::max(std::abs(p[0] - 128), std::abs(p[1] - 128)) <= 1);
      CHECK(p[2] >= 254);
    }
  }
  const asset::Asset out = asset::read_asset(result.glb, {}, {});
  const asset::Attribute& tangent = *out.primitives[0].find("TANGENT");
  const asset::Attribute& normal = *out.primitives[0].find("NORMAL");
  for (std::size_t v = 0; v < tangent.count(); ++v) {
    double across = 0, length = 0;
    for (std::uint32_t c = 0; c < 3; ++c) {
      across += tangent.get(v, c) * normal.get(v, c);
      length += tangent.get(v, c) * tangent.get(v, c);
    }
    CHECK(across == doctest::Approx(0).epsilon(1e-5).scale(1));
    CHECK(length == doctest::Approx(1).epsilon(1e-5));
    CHECK(tangent.get(v, 3) == 1); // charts are never mirrored
  }
}

TEST_CASE("under a node that mirrors, the bitangent points the other way") {
  const std::vector<std::pair<std::string, std::string>> settings{{"maps", "normal"}, {"lods", "0.2"}};
  const GltfBuilder plain = painted_sphere();
  GltfBuilder mirrored = painted_sphere(), both = painted_sphere();
  mirrored.json["nodes"][0]["scale"] = {-1, 1, 1};
  both.json["scenes"][0]["nodes"].push_back(both.append("nodes", Json{{"mesh", 0}, {"scale", {1, 1, -2}}}));
  const Result at_plain = run(plain, settings), at_mirrored = run(mirrored, settings), at_both = run(both, settings);
  CHECK(map_of(at_plain, "normal.png").pixels == map_of(at_mirrored, "normal.png").pixels);
  const auto tangents_of = [](const Result& result) {
    std::vector<asset::Attribute> out;
    for (const asset::Primitive& p : asset::read_asset(result.glb, {}, {}).primitives)
      out.push_back(*p.find("TANGENT"));
    return out;
  };
  const std::vector<asset::Attribute> straight = tangents_of(at_plain), turned = tangents_of(at_mirrored),
                                      split = tangents_of(at_both);
  REQUIRE(straight.size() == 2); // the full surface and a level
  REQUIRE(turned.size() == 2);
  REQUIRE(split.size() == 4); // and both for the node that mirrors
  for (std::size_t p = 0; p < 2; ++p) {
    REQUIRE(turned[p].count() == straight[p].count());
    for (std::size_t v = 0; v < straight[p].count(); ++v) CHECK(turned[p].get(v, 3) == -straight[p].get(v, 3));
    CHECK(split[p].data == straight[p].data);
    CHECK(split[p + 2].data == turned[p].data);
  }
  CHECK(std::ranges::count(at_both.report.notes, "mirrored-instances", &Note::code) == 0);
}

TEST_CASE("the levels of a node that mirrors mirror too") {
  GltfBuilder b = painted_sphere();
  b.json["scenes"][0]["nodes"].push_back(b.append("nodes", Json{{"mesh", 0}, {"scale", {1, 1, -1}}}));
  const Json json = json_of(run(b, {{"maps", "normal"}, {"lods", "0.2"}}).glb);
  const Json &straight = json["nodes"][0], &mirrored = json["nodes"][1];
  const auto level_of = [&](const Json& node) {
    return json["nodes"][node["extensions"]["MSFT_lod"]["ids"][0].get<std::size_t>()]["mesh"].get<int>();
  };
  CHECK(straight["mesh"] == 0);
  CHECK(level_of(straight) == 1);
  CHECK(mirrored["mesh"] == 2);
  CHECK(level_of(mirrored) == 3);
}

TEST_CASE("instances of one node that mirror, beside others that do not, are noted") {
  GltfBuilder b = painted_sphere();
  b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const std::size_t scales = b.add_accessor<float>({1, 1, 1, -1, 1, 1}, "VEC3", 3);
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = scales;
  const auto noted = [&](const char* maps) {
    return std::ranges::count(run(b, {{"maps", maps}}).report.notes, "mirrored-instances", &Note::code);
  };
  CHECK(noted("normal") == 1);
  CHECK(noted("base_color") == 0);
}

TEST_CASE("without normals a surface is flat, and its normal map says so on smooth vertices") {
  GltfBuilder b = painted_sphere();
  b.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
  b.json["materials"][0].erase("normalTexture");
  const Result result = run(b, {{"maps", "normal,object_normal"}, {"normal_bits", "16"}, {"texture_size", "512"}});
  CHECK(has(json_of(result.glb), "NORMAL"));
  CHECK(has(json_of(result.glb), "TANGENT"));
  const texture::Image normals = map_of(result, "normal.png"), object = map_of(result, "object_normal.png");
  // The triangles' own normals lean away from the smooth ones by up to half the angle between two of them, and there
  // are as many as triangles.
  int most = 0;
  std::set<std::array<int, 3>> flat;
  for (std::size_t i = 0; i < normals.pixels.size(); i += 3) {
    most = std::max(most, std::abs(normals.pixels[i] - 128));
    flat.insert({object.pixels[i], object.pixels[i + 1], object.pixels[i + 2]});
  }
  CHECK(most > 2);
  CHECK(most < 40);
  CHECK(flat.size() <= shapes::sphere(4).triangles.size());
}

TEST_CASE("the position map and its range give the surface back") {
  const Result result = run(painted_sphere(), {{"maps", "position"}});
  CHECK(names_of(result) == std::vector<std::string>{"position.png"});
  const Report::BakedMap& map = result.report.maps.at(0);
  CHECK(map.bits == 16);
  REQUIRE(map.range);
  const texture::Image image = map_of(result, "position.png"); // read as 8 bits
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const Vec3d n{image.pixels[i] / 255.0, image.pixels[i + 1] / 255.0, image.pixels[i + 2] / 255.0};
    const Vec3d& scale = map.range->scale;
    const Vec3d p = map.range->offset + Vec3d{n.x * scale.x, n.y * scale.y, n.z * scale.z};
    CHECK(norm(p) == doctest::Approx(1).epsilon(0.02)); // chords of the sphere, and 8 bits
  }
}

TEST_CASE("both sides of a seam see the same occlusion, as far as its rays tell") {
  NoProgress progress;
  mesh::TriangleMesh valleys = shapes::sphere(5);
  for (Vec3f& p : valleys.positions) p = normalized(p) * (1 + 0.3F * std::sin(7 * p.x) * std::sin(7 * p.y + 1));
  const std::vector<std::byte> glb = orbis::glb_of(valleys);
  Request request{glb, {}, {}};
  set_option(request.options, "maps", "ambient_occlusion");
  set_option(request.options, "texture_size", "1024");
  const Result result = process(request, {}, progress);
  const texture::Image map = map_of(result, "ambient_occlusion.png");
  const asset::Asset file = asset::read_asset(result.glb, {}, {});
  const asset::Attribute *sphere = file.primitives[0].find("_SPHERE"), *uv = file.primitives[0].find("TEXCOORD_0");
  REQUIRE(sphere != nullptr);
  REQUIRE(uv != nullptr);
  const texture::Sampler sampler(map, texture::Wrap::clamp, texture::Wrap::clamp, 1, texture::Encoding::linear);
  std::map<std::array<double, 3>, std::vector<double>> seen; // by place on the sphere
  for (std::size_t v = 0; v < sphere->count(); ++v) {
    const texture::Light light = sampler.sample(uv->get(v, 0) * map.width, uv->get(v, 1) * map.height, 0);
    seen[{sphere->get(v, 0), sphere->get(v, 1), sphere->get(v, 2)}].push_back(double{light[0]});
  }
  std::vector<double> differences;
  for (const auto& [place, values] : seen) {
    const auto [least, most] = std::ranges::minmax(values);
    if (values.size() > 1) differences.push_back(most - least);
  }
  REQUIRE(differences.size() > 50);
  std::sort(differences.begin(), differences.end());
}

namespace {

// A square from -1 to 1 at height z that faces +Z, in a material and with vertex colours of its own.
void add_square(GltfBuilder& b, float z, bool faces_up, const Json& material, float alpha) {
  const auto position = b.add_accessor(std::vector<float>{-1, -1, z, 1, -1, z, 1, 1, z, -1, 1, z}, "VEC3", 3);
  b.json["accessors"][position]["min"] = {-1, -1, z};
  b.json["accessors"][position]["max"] = {1, 1, z};
  std::vector<float> colors;
  for (int i = 0; i < 4; ++i) colors.insert(colors.end(), {0.5F, 0.5F, 0.5F, alpha});
  const std::vector<std::uint16_t> up{0, 1, 2, 0, 2, 3}, down{0, 2, 1, 0, 3, 2};
  const auto color = b.add_accessor(colors, "VEC4", 4), indices = b.add_accessor(faces_up ? up : down, "SCALAR", 1);
  Json primitive{{"attributes", {{"POSITION", position}, {"COLOR_0", color}}},
                 {"indices", indices},
                 {"material", b.append("materials", material)}};
  if (b.json.contains("meshes"))
    b.json["meshes"][0]["primitives"].push_back(primitive);
  else
    b.add_mesh(primitive);
}

// The occlusion in the middle of a floor under a roof close to it.
int light_under(const Json& roof, bool faces_up, float alpha) {
  GltfBuilder b;
  add_square(b, 0, true, Json::object(), 1);
  add_square(b, 0.1F, faces_up, roof, alpha);
  const Result result = run(b, {{"maps", "auto,ambient_occlusion"}, {"texture_size", "128"}});
  const texture::Image map = map_of(result, "ambient_occlusion-1.png");
  return map.at(map.width / 2, map.height / 2)[0];
}

} // namespace

// Leaf cards had been shaded by the whole of their squares, and what lies under a surface that is not drawn from below.
TEST_CASE("what is not drawn hides no sky: backs of single sides, what masks leave out, what is blended") {
  const Json masked{{"alphaMode", "MASK"}, {"doubleSided", true}};
  CHECK(light_under({{"doubleSided", true}}, true, 0) < 60);
  CHECK(light_under(masked, true, 0.6F) < 60);
  CHECK(light_under(masked, true, 0.4F) == 255);
  CHECK(light_under({{"alphaMode", "BLEND"}, {"doubleSided", true}}, true, 0.9F) == 255);
  CHECK(light_under(Json::object(), false, 1) < 60);
  CHECK(light_under(Json::object(), true, 1) == 255);
}

TEST_CASE("every level has a displacement map, and the coarser one has more to displace") {
  const GltfBuilder b = painted_sphere();
  const Result result = run(b, {{"maps", "displacement"}, {"lods", "0.25,0.02"}});
  CHECK(names_of(result) == std::vector<std::string>{"displacement_lod1.png", "displacement_lod2.png"});
  std::array<double, 2> most{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Report::BakedMap& map = result.report.maps.at(i);
    CAPTURE(map.name);
    CHECK(map.bits == 16);
    REQUIRE(map.range);
    most[i] = map.range->scale.x;
    // The level's vertices lie outside of the sphere, the middles of its triangles inside.
    CHECK(map.range->offset.x < 0);
    CHECK(map.range->offset.x + map.range->scale.x > 0);
  }
  CHECK(most[0] < 0.05);
  CHECK(most[1] > 3 * most[0]);
  CHECK(most[1] < 0.4);
}

TEST_CASE("without levels there is nothing to displace, and the report says so") {
  const Result result = run(painted_sphere(), {{"maps", "displacement"}});
  CHECK(result.maps.empty());
  REQUIRE(std::ranges::count(result.report.notes, "map-not-baked", &Note::code) == 1);
}

TEST_CASE("the atlas is as large as the texel density asks for, and says where it cannot be") {
  constexpr double area = 12.4; // of the divided icosahedron, a little less than the sphere's
  const auto density_of = [](const Result& r) {
    const Report::BakedMap& map = r.report.maps.at(0);
    return std::sqrt(r.report.atlas.utilisation * map.width * map.height / area);
  };
  const Result coarse = run(painted_sphere(), {{"texel_density", "20"}});
  const Result fine = run(painted_sphere(), {{"texel_density", "60"}});
  CHECK(density_of(coarse) == doctest::Approx(20).epsilon(0.15));
  CHECK(density_of(fine) == doctest::Approx(60).epsilon(0.15));
  CHECK(std::ranges::count(fine.report.notes, "texel-density-lowered", &Note::code) == 0);
}

TEST_CASE("a map that nothing could be baked from is noted") {
  GltfBuilder b = painted_sphere();
  b.json["materials"][0].erase("emissiveTexture");
  const Result result = run(b, {{"maps", "emissive"}});
  CHECK(result.maps.empty());
  CHECK(std::ranges::any_of(result.report.notes, [](const Note& n) { return n.code == "map-not-baked"; }));
}

TEST_CASE("images are stored in the format that was asked for, normal maps always without loss") {
  const Result jpeg = run(painted_sphere(), {{"texture_format", "jpeg"}});
  CHECK(names_of(jpeg) == std::vector<std::string>{"base_color.jpeg", "occlusion_roughness_metallic.jpeg",
                                                   "emissive.jpeg", "normal.png"});
  const Result webp = run(painted_sphere(), {{"texture_format", "webp"}});
  CHECK(map_of(webp, "normal.webp").pixels == map_of(jpeg, "normal.png").pixels);
  CHECK(json_of(webp.glb)["extensionsRequired"] == Json{"EXT_texture_webp"});
}

TEST_CASE("all maps are the same bytes on any number of threads") {
  const auto maps_on = [](const char* threads) {
    std::vector<std::vector<std::byte>> bytes;
    for (const MapFile& map : run(painted_sphere(), {{"maps", "all"}, {"threads", threads}}).maps)
      bytes.push_back(map.bytes);
    return bytes;
  };
  const auto once = maps_on("1");
  CHECK(once.size() >= 6);
  CHECK(maps_on("3") == once);
}

TEST_CASE("levels of detail show the full surface's maps, and one normal map for all of them") {
  const Result result = run(painted_sphere(), {{"lods", "0.5,0.1"}});
  const std::vector<std::string> names = names_of(result);
  CHECK(std::ranges::count(names, "normal_lods.png") == 1);
  const Json json = json_of(result.glb);
  REQUIRE(json["meshes"].size() == 3);
  const auto primitive = [&](std::size_t mesh) -> const Json& { return json["meshes"][mesh]["primitives"][0]; };
  const auto material = [&](std::size_t mesh) -> const Json& {
    return json["materials"][primitive(mesh)["material"].get<std::size_t>()];
  };
  CHECK(primitive(1)["material"] == primitive(2)["material"]);
  CHECK(material(1)["normalTexture"]["index"] != material(0)["normalTexture"]["index"]);
  CHECK(material(1)["pbrMetallicRoughness"] == material(0)["pbrMetallicRoughness"]);
  for (const std::size_t mesh : {0U, 1U, 2U}) {
    CHECK(primitive(mesh)["attributes"].contains("TANGENT"));
    CHECK_FALSE(primitive(mesh)["attributes"].contains("COLOR_0"));
  }
}
