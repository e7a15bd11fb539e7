// The morph target that takes a model to its spheres.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/gltf_builder.h"
#include "support/shapes.h"

using namespace orbis;
using test::GltfBuilder;
using test::Json;

namespace {

Result run(const GltfBuilder& b, const std::vector<std::pair<std::string, std::string>>& more = {}) {
  NoProgress progress;
  const test::Bytes glb = b.glb();
  Request request{glb, {}, {}};
  request.options.texture_size = 128;
  set_option(request.options, "sphere_morph", "true");
  for (const auto& [name, value] : more) set_option(request.options, name, value);
  return process(request, {}, progress);
}

Json json_of(const Result& result) {
  const auto text = asset::split_glb(result.glb).json;
  return Json::parse(reinterpret_cast<const char*>(text.data()),
                     reinterpret_cast<const char*>(text.data()) + text.size());
}

Json primitive_json(GltfBuilder& b, const mesh::TriangleMesh& m, bool with_normals = true) {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;
  for (const Vec3f& p : m.positions) {
    positions.insert(positions.end(), {p.x, p.y, p.z});
    const Vec3f n = normalized(p);
    normals.insert(normals.end(), {n.x, n.y, n.z});
  }
  for (const auto& t : m.triangles) indices.insert(indices.end(), t.begin(), t.end());
  Json attributes;
  attributes["POSITION"] = b.add_accessor(positions, "VEC3", 3);
  if (with_normals) attributes["NORMAL"] = b.add_accessor(normals, "VEC3", 3);
  return Json{{"attributes", attributes}, {"indices", b.add_accessor(indices, "SCALAR", 1)}};
}

double area_of(const mesh::TriangleMesh& m) {
  double sum = 0;
  for (const auto& [i, j, k] : m.triangles) {
    const Vec3d p(m.positions[i]);
    sum += norm(cross(Vec3d(m.positions[j]) - p, Vec3d(m.positions[k]) - p)) / 2;
  }
  return sum;
}

} // namespace

TEST_CASE(
    "at weight 1 each vertex is on its component's sphere, which has the component's area, and so is its normal") {
  const mesh::TriangleMesh shape = shapes::moved(shapes::bumpy_sphere(4), {3, 0, 0});
  GltfBuilder b;
  b.add_mesh(primitive_json(b, shape));
  const Result result = run(b);
  const asset::Primitive p = asset::read_asset(result.glb, {}, {}).primitives.at(0);
  REQUIRE(p.targets.size() == 1);
  REQUIRE(p.targets[0].size() == 2);
  const double radius = std::sqrt(area_of(shape) / (4 * std::numbers::pi));
  Vec3d low{1e9, 1e9, 1e9}, high = low * -1.0;
  for (std::size_t v = 0; v < p.vertex_count(); ++v) {
    const Vec3d at = vector_at(*p.find("POSITION"), v) + vector_at(p.targets[0][0], v);
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
  }
  const Vec3d centre = (low + high) * 0.5;
  for (std::size_t v = 0; v < p.vertex_count(); ++v) {
    const Vec3d s = vector_at(*p.find("_SPHERE"), v);
    const Vec3d at = vector_at(*p.find("POSITION"), v) + vector_at(p.targets[0][0], v);
    CHECK(norm(at - centre - s * radius) < 0.02);
    CHECK(norm(vector_at(*p.find("NORMAL"), v) + vector_at(p.targets[0][1], v) - s) < 1e-5);
  }
  const Json mesh = json_of(result)["meshes"][0];
  CHECK(mesh["extras"]["targetNames"] == Json::array({"sphere"}));
  CHECK(mesh["weights"] == Json::array({0}));
}

TEST_CASE("existing targets, weights and animations go on as they were, with a zero for the sphere") {
  GltfBuilder b;
  const mesh::TriangleMesh shape = shapes::bumpy_sphere(3);
  Json primitive = primitive_json(b, shape);
  const std::vector<float> moves(3 * shape.positions.size(), 0.25F);
  const auto target = b.add_accessor(moves, "VEC3", 3);
  primitive["targets"] = Json::array({Json{{"POSITION", target}}, Json{{"POSITION", target}}});
  const auto corners = b.add_accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "VEC3", 3);
  Json points{{"attributes", {{"POSITION", corners}}}, {"mode", 0}};
  points["targets"] = Json::array({Json{{"POSITION", corners}}, Json{{"POSITION", corners}}});
  b.add_mesh(primitive);
  b.json["meshes"][0]["primitives"].push_back(points);
  b.json["meshes"][0]["weights"] = {0.5, 0.25};
  b.json["nodes"][0]["weights"] = {0.75, 0};
  const auto times = b.add_accessor(std::vector<float>{0, 1}, "SCALAR", 1);
  const auto weights = b.add_accessor(std::vector<float>{1, 2, 3, 4}, "SCALAR", 1);
  b.json["animations"] = Json::array(
      {Json{{"samplers", Json::array({Json{{"input", times}, {"output", weights}}})},
            {"channels", Json::array({Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
  const Result result = run(b);
  const Json json = json_of(result);
  const Json& mesh = json["meshes"][0];
  CHECK(mesh["extras"]["targetNames"] == Json::array({"0", "1", "sphere"}));
  CHECK(mesh["weights"] == Json::array({0.5, 0.25, 0}));
  CHECK(json["nodes"][0]["weights"] == Json::array({0.75, 0, 0}));
  for (const Json& p : mesh["primitives"]) CHECK(p["targets"].size() == 3);
  const Json& animation = json["animations"][0];
  const Json& sampler = animation["samplers"][animation["channels"][0]["sampler"].get<std::size_t>()];
  CHECK(json["accessors"][sampler["output"].get<std::size_t>()]["count"] == 6);
  // The same file again: read, and with one more target yet.
  CHECK(asset::read_asset(result.glb, {}, {}).primitives.at(0).targets.size() == 3);
}

TEST_CASE("each of several components goes to a sphere of its own, on levels of detail too; duplicates go along") {
  GltfBuilder b;
  mesh::TriangleMesh both = shapes::joined(shapes::bumpy_sphere(3), shapes::moved(shapes::sphere(3), {9, 0, 0}));
  both.triangles.push_back(both.triangles.front());
  b.add_mesh(primitive_json(b, both));
  const Result result = run(b, {{"lods", "0.5"}});
  for (const asset::Primitive& p : asset::read_asset(result.glb, {}, {}).primitives) {
    REQUIRE(p.targets.size() == 1);
    for (std::size_t v = 0; v < p.vertex_count(); ++v) {
      const Vec3d at = vector_at(*p.find("POSITION"), v), to = at + vector_at(p.targets[0][0], v);
      const double radius = norm(to - Vec3d{at.x > 4 ? 9.0 : 0.0, 0, 0});
      CHECK(radius > 0.5);
      CHECK(radius < 2);
    }
  }
}
