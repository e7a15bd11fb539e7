// One mesh that morphs from a model to another.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/asset/asset.h"
#include "core/asset/glb.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/glb_of_mesh.h"

using namespace orbis;

namespace {

Result run(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b,
           const std::vector<std::pair<std::string, std::string>>& more = {}) {
  NoProgress progress;
  const std::vector<std::byte> first = glb_of(a);
  Request request{first, {}, {}};
  request.options.texture_size = 128;
  request.files["models/ball.glb"] = glb_of(b);
  set_option(request.options, "morph_to", "models/ball.glb");
  for (const auto& [name, value] : more) set_option(request.options, name, value);
  return process(request, {}, progress);
}

// A ball of radius 2 around (7, 0, 0), longer along x.
mesh::TriangleMesh ball() {
  mesh::TriangleMesh m = shapes::sphere(4);
  for (Vec3f& p : m.positions) p = {3 * p.x + 7, 2 * p.y, 2 * p.z};
  return m;
}

// 1 on the surface of the ball.
double in_ball(const Vec3d& p) { return std::sqrt((p.x - 7) * (p.x - 7) / 9 + p.y * p.y / 4 + p.z * p.z / 4); }

std::string refusal(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
  try {
    (void)run(a, b);
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::not_genus_zero);
    return e.message();
  }
  return "";
}

} // namespace

TEST_CASE("the mesh is the first model at weight 0 and the second at weight 1, on a common triangulation") {
  const Result result = run(shapes::bumpy_sphere(4), ball());
  const Report& report = result.report;
  REQUIRE(report.remesh);
  REQUIRE(report.morph);
  CHECK(report.certificate.valid);
  CHECK(report.morph->format == "glb");
  CHECK(report.morph->input_triangles == 2048);
  CHECK(report.remesh->triangles == 5120); // the icosahedron that first has as many as both
  CHECK(report.remesh->hausdorff_distance < 2);
  CHECK(report.morph->mean_distance < 0.3);
  CHECK(report.morph->mean_distance_from_input < 0.3);
  CHECK(report.morph->hausdorff_distance < 2);
  const asset::Primitive p = asset::read_asset(result.glb, {}, {}).primitives.at(0);
  REQUIRE(p.targets.size() == 1);
  for (std::size_t v = 0; v < p.vertex_count(); ++v)
    CHECK(in_ball(vector_at(*p.find("POSITION"), v) + vector_at(p.targets[0][0], v)) ==
          doctest::Approx(1).epsilon(0.03));
  const auto text = asset::split_glb(result.glb).json;
  const std::string json(reinterpret_cast<const char*>(text.data()), text.size());
  CHECK(json.find(R"("targetNames":["ball"])") != std::string::npos);
}

TEST_CASE("models of very different sizes are noted: they may be in different units") {
  const auto is_noted = [](float scale) {
    mesh::TriangleMesh large = shapes::sphere(2);
    for (Vec3f& p : large.positions) p *= scale;
    return std::ranges::any_of(run(shapes::sphere(2), large).report.notes,
                               [](const Note& n) { return n.code == "morph-sizes"; });
  };
  CHECK(is_noted(100));
  CHECK(is_noted(0.01F));
  CHECK(!is_noted(2));
}

TEST_CASE("features meet: the vertex at the first model's point goes to the second's") {
  // A thorn of the first model is to become a point far from its direction.
  mesh::TriangleMesh thorn = shapes::bumpy_sphere(4);
  const auto top = std::ranges::max_element(thorn.positions, {}, &Vec3f::z);
  *top = *top * 1.5F;
  const Vec3f tip = *top;
  const std::string from =
      "[" + std::to_string(tip.x) + "," + std::to_string(tip.y) + "," + std::to_string(tip.z) + "]";
  const Result result = run(thorn, ball(), {{"features", "[[" + from + ",[7,0.8,1.8]]]"}, {"remesh", "icosahedral:4"}});
  REQUIRE(result.report.morph);
  CHECK(result.report.morph->features == 1);
  CHECK(result.report.morph->mean_angle_before > 5);
  CHECK(result.report.morph->largest_angle < 0.1);
  const asset::Primitive p = asset::read_asset(result.glb, {}, {}).primitives.at(0);
  double nearest = 1e9;
  Vec3d becomes;
  for (std::size_t v = 0; v < p.vertex_count(); ++v) {
    const Vec3d at = vector_at(*p.find("POSITION"), v);
    if (norm(at - Vec3d(tip)) > nearest) continue;
    nearest = norm(at - Vec3d(tip));
    becomes = at + vector_at(p.targets[0][0], v);
  }
  CHECK(norm(becomes - Vec3d{7, 0.8, 1.8}) < 0.3); // the nearest vertices of the ball are 0.15 away
}

TEST_CASE("three features turn the sphere before anything is bent") {
  // The same shape, lying otherwise: x -> y -> z -> x.
  const mesh::TriangleMesh a = shapes::bumpy_sphere(4);
  mesh::TriangleMesh b = a;
  for (Vec3f& p : b.positions) p = {p.z, p.x, p.y};
  std::string pairs;
  for (const std::size_t v : {std::size_t{3}, std::size_t{90}, std::size_t{400}, std::size_t{777}}) {
    const auto text = [](const Vec3f& p) {
      return "[" + std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) + "]";
    };
    pairs += (pairs.empty() ? "[[" : ",[") + text(a.positions[v]) + "," + text(b.positions[v]) + "]";
  }
  const Result result = run(a, b, {{"features", pairs + "]"}});
  CHECK(result.report.morph->features == 4);
  CHECK(result.report.morph->mean_angle_before > 30);
  CHECK(result.report.morph->largest_angle < 0.2);
  const asset::Primitive p = asset::read_asset(result.glb, {}, {}).primitives.at(0);
  double sum = 0;
  for (std::size_t v = 0; v < p.vertex_count(); ++v) {
    const Vec3d at = vector_at(*p.find("POSITION"), v), to = at + vector_at(p.targets[0][0], v);
    sum += norm(to - Vec3d{at.z, at.x, at.y});
  }
  CHECK(sum / static_cast<double>(p.vertex_count()) < 0.05);
}

TEST_CASE("models that are not one sphere each are refused by name and defect, and so is a file that did not come") {
  const mesh::TriangleMesh good = shapes::bumpy_sphere(3);
  const mesh::TriangleMesh two = shapes::joined(good, shapes::moved(good, {9, 0, 0}));
  CHECK(refusal(two, good).find("the first model has 2 components") != std::string::npos);
  CHECK(refusal(good, two).find("the second model has 2 components") != std::string::npos);
  CHECK(refusal(good, shapes::disk(4, 8)).find("the second model has holes") != std::string::npos);
  CHECK_THROWS_AS((void)run(good, good, {{"morph_to", "other.glb"}}), Error);
  CHECK_THROWS_AS((void)run(good, good, {{"sphere_morph", "true"}}), Error);
}

TEST_CASE("features without a second model are refused") {
  NoProgress progress;
  const std::vector<std::byte> glb = glb_of(shapes::sphere(2));
  Request request{glb, {}, {}};
  set_option(request.options, "features", "[[[0,0,1],[0,0,2]]]");
  try {
    (void)process(request, {}, progress);
    FAIL("accepted");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::invalid_option);
    CHECK(e.where() == "features");
  }
}

TEST_CASE("feature pairs are read and written; anything else is refused") {
  Options options;
  set_option(options, "features", " [ [[1,2,3], [-4.5,0,1e2]],[[0,0,0],[0,0,1]] ] ");
  CHECK(options.features.size() == 2);
  CHECK(options.features[0].to == Vec3d{-4.5, 0, 100});
  CHECK(get_option(options, "features") == "[[[1,2,3],[-4.5,0,100]],[[0,0,0],[0,0,1]]]");
  set_option(options, "features", "");
  CHECK(options.features.empty());
  for (const char* bad : {"nose", "[", "[[1,2,3],[4,5,6]]", "[[[1,2],[3,4]]]", "[[[1,2,3],[4,5,6]]",
                          "[[[1,2,3],[4,5,nan]]]", "[[[1,2,3],[4,5,6]]]]", "[[[1,2,3],[4,5,6]],]"})
    CHECK_THROWS_AS(set_option(options, "features", bad), Error);
}
