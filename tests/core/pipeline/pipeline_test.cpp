#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/asset/asset.h"
#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "support/glb_of_mesh.h"

using namespace orbis;

namespace {

Result run(const std::vector<std::byte>& glb, const Options& options = {},
           std::map<std::string, std::vector<std::byte>, std::less<>> files = {}) {
  NoProgress progress;
  Request request{glb, std::move(files), options};
  request.options.texture_size = 256;
  return process(request, {}, progress);
}

ErrorCode code_of(const std::vector<std::byte>& glb) {
  try {
    static_cast<void>(run(glb));
  } catch (const Error& e) {
    CHECK_FALSE(e.message().empty());
    return e.code();
  }
  FAIL("the model was taken");
  return ErrorCode::internal;
}

asset::Asset read(const std::vector<std::byte>& glb) { return asset::read_asset(glb, {}, {}); }

double area_of(const asset::Primitive& p) {
  const std::vector<Vec3f> positions = p.positions();
  double area = 0;
  for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
    const Vec3d a(positions[p.indices[i]]), b(positions[p.indices[i + 1]]), c(positions[p.indices[i + 2]]);
    area += norm(cross(b - a, c - a)) / 2;
  }
  return area;
}

std::set<std::array<float, 3>> positions_of(const asset::Primitive& p) {
  std::set<std::array<float, 3>> out;
  for (const Vec3f& v : p.positions()) out.insert({v.x, v.y, v.z});
  return out;
}

Options with(std::string_view name, std::string_view value) {
  Options options;
  set_option(options, name, value);
  return options;
}

} // namespace

TEST_CASE("a sphere-like mesh comes back certified, with its whole surface, under both objectives") {
  for (const std::string_view objective : {"isometric", "shape-preserving"}) {
    for (const mesh::TriangleMesh& m : {shapes::tetrahedron(), shapes::bumpy_sphere(4), shapes::bipyramid(50)}) {
      CAPTURE(objective);
      const std::vector<std::byte> glb = glb_of(m);
      const Result result = run(glb, with("objective", objective));
      CHECK(result.report.certificate.valid);
      CHECK(result.report.cut_certificate.valid);
      CHECK(result.report.certificate.triangles == m.triangles.size());
      const asset::Asset out = read(result.glb);
      REQUIRE(out.primitives.size() == 1);
      const asset::Primitive input = read(glb).primitives[0];
      CHECK(area_of(out.primitives[0]) == doctest::Approx(area_of(input)).epsilon(1e-6));
      const auto delivered = positions_of(out.primitives[0]);
      for (const auto& p : positions_of(input)) CHECK(delivered.contains(p));
      REQUIRE(out.primitives[0].find("TEXCOORD_0") != nullptr);
      REQUIRE(out.primitives[0].find("_SPHERE") != nullptr);
    }
  }
}

TEST_CASE("the same input gives the same bytes, with any number of threads") {
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(5));
  const std::vector<std::byte> once = run(glb, with("threads", "1")).glb;
  CHECK(run(glb, with("threads", "1")).glb == once);
  CHECK(run(glb, with("threads", "3")).glb == once);
}

TEST_CASE("all texture coordinates lie in the atlas") {
  const asset::Asset out = read(run(glb_of(shapes::bumpy_sphere(4))).glb);
  const asset::Attribute& uv = *out.primitives[0].find("TEXCOORD_0");
  for (std::size_t v = 0; v < uv.count(); ++v) {
    for (std::uint32_t c = 0; c < 2; ++c) {
      CHECK(uv.get(v, c) >= 0);
      CHECK(uv.get(v, c) <= 1);
    }
  }
}

TEST_CASE("seams are welded for the topology and restored in the output") {
  // Every triangle has vertices of its own, each with its own texture coordinate.
  const mesh::TriangleMesh m = shapes::sphere(3);
  const Result result = run(soup_glb_of(m));
  CHECK(result.report.topology.vertices == m.positions.size());
  CHECK(result.report.input_vertices == 3 * m.triangles.size());
  const asset::Asset out = read(result.glb);
  const asset::Primitive& p = out.primitives[0];
  REQUIRE(p.find("TEXCOORD_1") != nullptr); // the atlas: the input's own set 0 stays
  std::set<std::array<double, 2>> own;
  const asset::Attribute& uv = *p.find("TEXCOORD_0");
  for (std::size_t v = 0; v < uv.count(); ++v) own.insert({uv.get(v, 0), uv.get(v, 1)});
  const asset::Asset input = read(soup_glb_of(m));
  const asset::Attribute& before = *input.primitives[0].find("TEXCOORD_0");
  for (std::size_t v = 0; v < before.count(); ++v) CHECK(own.contains({before.get(v, 0), before.get(v, 1)}));
}

TEST_CASE("several closed components come back in one file, each certified on a sphere of its own") {
  mesh::TriangleMesh both = shapes::bumpy_sphere(3);
  const auto first = static_cast<mesh::Index>(both.positions.size());
  const mesh::TriangleMesh small = shapes::bipyramid(7);
  for (const Vec3f& p : small.positions) both.positions.push_back(p + Vec3f{9, 0, 0});
  for (const auto& [i, j, k] : small.triangles) both.triangles.push_back({first + i, first + j, first + k});
  const std::vector<std::byte> glb = glb_of(both);
  const Result result = run(glb, with("threads", "1"));
  CHECK(result.report.topology.components == 2);
  CHECK(result.report.certificate.valid);
  CHECK(result.report.certificate.triangles == both.triangles.size());
  CHECK(result.report.cut_certificate.valid);
  CHECK(area_of(read(result.glb).primitives[0]) == doctest::Approx(area_of(read(glb).primitives[0])).epsilon(1e-6));
  CHECK(run(glb, with("threads", "3")).glb == result.glb);
}

TEST_CASE("a rolled-up tube seven thousand times as long as thick comes back") {
  mesh::TriangleMesh tube;
  constexpr mesh::Index rings = 2000;
  for (mesh::Index i = 0; i < rings; ++i) {
    const double turn = 0.05 * i, radius = 1 + 0.002 * i;
    for (int k = 0; k < 3; ++k) {
      const double around = 2 * std::numbers::pi * k / 3, r = radius + 0.02 * std::cos(around);
      tube.positions.emplace_back(Vec3d{r * std::cos(turn), r * std::sin(turn), 0.02 * std::sin(around)});
    }
  }
  for (mesh::Index i = 0; i + 1 < rings; ++i)
    for (mesh::Index k = 0; k < 3; ++k) {
      const mesh::Index a = 3 * i + k, b = 3 * i + (k + 1) % 3;
      tube.triangles.push_back({a, b, b + 3});
      tube.triangles.push_back({a, b + 3, a + 3});
    }
  tube.triangles.push_back({2, 1, 0});
  tube.triangles.push_back({3 * rings - 3, 3 * rings - 2, 3 * rings - 1});
  Options options;
  options.texture_size = 256;
  const Report report = run(glb_of(tube), options).report;
  CHECK(report.certificate.valid);
  CHECK_FALSE(report.partial);
}

TEST_CASE("a surface without extent is refused") {
  mesh::TriangleMesh point = shapes::sphere(2);
  for (Vec3f& p : point.positions) p = {1, 2, 3};
  CHECK(code_of(glb_of(point)) == ErrorCode::invalid_geometry);
}

TEST_CASE("mixed windings are turned and said so") {
  mesh::TriangleMesh m = shapes::sphere(3);
  for (std::size_t t = 0; t < m.triangles.size(); t += 3) std::swap(m.triangles[t][0], m.triangles[t][1]);
  const Result result = run(glb_of(m));
  CHECK(result.report.certificate.valid);
  CHECK(result.report.repairs.turned_triangles == (m.triangles.size() + 2) / 3);
}

TEST_CASE("an uploaded cube map shows up in the atlas, and a missing face is named") {
  std::map<std::string, std::vector<std::byte>, std::less<>> files;
  texture::Image red{8, 8, 3, {}};
  for (int i = 0; i < 64; ++i) red.pixels.insert(red.pixels.end(), {200, 10, 20});
  for (const char* name : {"px.png", "nx.png", "py.png", "ny.png", "pz.png"}) files[name] = asset::encode_png(red);
  const Options options = with("texture", "cubemap");
  const std::vector<std::byte> glb = glb_of(shapes::sphere(3));
  CHECK_THROWS_WITH_AS(static_cast<void>(run(glb, options, files)), doctest::Contains("'nz' did not come"), Error);
  files["nz.png"] = asset::encode_png(red);
  const Result result = run(glb, options, files);
  CHECK(result.report.atlas.source == "cubemap");
  const texture::Image atlas = asset::decode_image(result.atlas_png, 1 << 24, "");
  CHECK(std::ranges::equal(std::span(atlas.at(60, 60), 3), std::vector<std::uint8_t>{200, 10, 20}));
}

TEST_CASE("texture=base_color on a model without one is refused") {
  CHECK_THROWS_AS(static_cast<void>(run(glb_of(shapes::sphere(2)), with("texture", "base_color"))), Error);
}

TEST_CASE("compressed output is smaller and holds what the certificate speaks of to the bit") {
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(4));
  Options options = with("maps", "base_color,normal");
  const Result result = run(glb, options);
  const asset::Asset plain = read(result.glb);
  for (const char* compression : {"draco", "meshopt", "quantized"}) {
    CAPTURE(compression);
    set_option(options, "compression", compression);
    const Result packed = run(glb, options);
    CHECK(packed.glb.size() < result.glb.size());
    CHECK(packed.report.certificate.valid);
    const asset::Primitive &before = plain.primitives[0], after = read(packed.glb).primitives[0];
    for (const char* name : {"POSITION", "_SPHERE", "TEXCOORD_0"}) {
      CHECK(before.find(name)->data == after.find(name)->data);
    }
    const bool is_quantised = std::string_view(compression) == "quantized";
    for (const char* name : {"NORMAL", "TANGENT"}) {
      CHECK(after.find(name)->type == (is_quantised ? asset::ComponentType::i16 : asset::ComponentType::f32));
    }
  }
}

TEST_CASE("every stage reports, in order, and the stages' times are in the report") {
  class Recorder final : public Progress {
  public:
    void report(Stage stage, std::uint64_t done, std::uint64_t total) override {
      CHECK(done <= total);
      CHECK((stages.empty() || stages.back() <= stage));
      if (stages.empty() || stages.back() != stage) stages.push_back(stage);
    }
    [[nodiscard]] bool cancelled() const override { return false; }
    std::vector<Stage> stages;
  } recorder;
  const std::vector<std::byte> glb = glb_of(shapes::bumpy_sphere(4));
  Request request;
  request.model = glb;
  const Result result = process(request, {}, recorder);
  CHECK(recorder.stages.size() == stage_count);
  CHECK(result.report.stages.size() == stage_count);
}

TEST_CASE("stages can be dumped to look at") {
  std::map<std::string, std::string> dumped;
  const std::vector<std::byte> glb = glb_of(shapes::tetrahedron());
  NoProgress progress;
  Request request;
  request.model = glb;
  static_cast<void>(process(request, {}, progress, [&](std::string_view name, std::span<const std::byte> bytes) {
    dumped[std::string(name)] = std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }));
  CHECK(dumped.at("1-surface.obj").starts_with("v "));
  CHECK(dumped.contains("2-sphere.obj"));
  CHECK(dumped.contains("3-charts.obj"));
  CHECK(dumped.at("4-atlas.png").substr(1, 3) == "PNG");
}

TEST_CASE("skin weights of new vertices add up to one, with the strongest joints") {
  const Result result = run(skinned_glb_of(shapes::sphere(1)));
  const asset::Asset out = read(result.glb);
  const asset::Attribute& joints = *out.primitives[0].find("JOINTS_0");
  const asset::Attribute& weights = *out.primitives[0].find("WEIGHTS_0");
  REQUIRE(weights.count() > shapes::sphere(1).positions.size());
  for (std::size_t v = 0; v < weights.count(); ++v) {
    double sum = 0;
    std::set<double> seen;
    for (std::uint32_t c = 0; c < 4; ++c) {
      sum += weights.get(v, c);
      if (weights.get(v, c) > 0) {
        CHECK(seen.insert(joints.get(v, c)).second);
      } else {
        CHECK(joints.get(v, c) == 0);
      }
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-6));
  }
}
