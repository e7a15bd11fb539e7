#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::TriangleMesh;

namespace {

std::vector<Vec3f> delivered(const TriangleMesh& m, std::uint32_t threads = 1) {
  NoProgress progress;
  const sphere::Embedding e = sphere::embed_isometric(m, Quality::standard, threads, progress);
  const sphere::Snapped snapped = sphere::snap(e.points, m.triangles);
  std::vector<Vec3f> out;
  for (const sphere::GridPoint& p : snapped.points) out.push_back(sphere::from_grid(p));
  return out;
}

void check_certified(const TriangleMesh& m) {
  const sphere::Certificate c = sphere::certify(delivered(m), m.triangles);
  CHECK(c.failure() == "");
  CHECK(c.valid);
}

TriangleMesh scaled(TriangleMesh m, float s) {
  for (Vec3f& p : m.positions) p *= s;
  return m;
}

class CancelsAfter final : public Progress {
public:
  explicit CancelsAfter(int reports) : left_(reports) {}
  void report(Stage, std::uint64_t, std::uint64_t) override { --left_; }
  [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

private:
  int left_;
};

class Recorder final : public Progress {
public:
  void report(Stage stage, std::uint64_t done, std::uint64_t total) override {
    CHECK(done <= total);
    CHECK(stage >= stage_);
    if (stage == stage_) CHECK(done >= done_);
    stage_ = stage;
    done_ = done;
  }
  [[nodiscard]] bool cancelled() const override { return false; }

private:
  Stage stage_ = Stage::decode;
  std::uint64_t done_ = 0;
};

} // namespace

TEST_CASE("every map of a sphere-like mesh is certified") {
  check_certified(shapes::tetrahedron());
  check_certified(shapes::bipyramid(3)); // five vertices
  check_certified(shapes::bipyramid(4));
  check_certified(shapes::sphere(5));
  check_certified(shapes::bumpy_sphere(5));
}

TEST_CASE("extreme shapes are certified") {
  check_certified(shapes::spike(5, 10));
  check_certified(shapes::spike(5, 1000));
  check_certified(shapes::tube(400, 6, 2000));
  check_certified(shapes::bipyramid(1000));
  check_certified(shapes::bipyramid(1000, 1e-6F));
}

TEST_CASE("degenerate geometry is certified") {
  TriangleMesh flat = shapes::sphere(4);
  for (Vec3f& p : flat.positions) p.z = 0; // all triangles in one plane
  check_certified(flat);

  TriangleMesh line = shapes::sphere(4);
  for (Vec3f& p : line.positions) p.y = p.z = 0; // no triangle has any area
  check_certified(line);

  TriangleMesh coincident = shapes::sphere(4);
  for (std::size_t v = 0; v < coincident.positions.size(); v += 3) coincident.positions[v] = coincident.positions[0];
  check_certified(coincident);
}

TEST_CASE("needles and tiny extremities are certified") {
  TriangleMesh needles = shapes::bumpy_sphere(4);
  for (Vec3f& p : needles.positions) p.x *= 1e6F;
  check_certified(needles);

  // A cap with all of its detail, drawn together until it holds 10^-8 of the area and less.
  for (const float size : {1e-4F, 1e-6F}) {
    TriangleMesh extremity = shapes::sphere(5);
    for (Vec3f& p : extremity.positions) {
      if (p.z > 0.5F) p = {p.x * size, p.y * size, 0.5F + (p.z - 0.5F) * size};
    }
    check_certified(extremity);
  }
}

TEST_CASE("the size of the coordinates does not matter") {
  const TriangleMesh m = shapes::bumpy_sphere(4);
  for (const float s : {1e-37F, 1e-44F, 1e-30F, 1e30F, 1e38F}) check_certified(scaled(m, s));
  // Powers of two are exact, so even the bits agree.
  CHECK(delivered(scaled(m, 0x1p90F)) == delivered(m));
  CHECK(delivered(scaled(m, 0x1p-90F)) == delivered(m));
  TriangleMesh outlier = m;
  outlier.positions[17].x = 3e38F;
  check_certified(outlier);
}

TEST_CASE("random triangulations with random positions are certified") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    const std::size_t vertices = 5 + seed * seed;
    check_certified(shapes::RandomTriangulation(seed).make(vertices, 10 * vertices));
    // Without flips: valences grow without bound, and rings have few legal parents.
    check_certified(shapes::RandomTriangulation(seed).make(vertices, 0));
  }
}

TEST_CASE("the bytes do not depend on the number of threads") {
  const TriangleMesh m = shapes::bumpy_sphere(6);
  const std::vector<Vec3f> one = delivered(m, 1);
  CHECK(delivered(m, 2) == one);
  CHECK(delivered(m, 5) == one);
}

TEST_CASE("a sphere is mapped almost isometrically") {
  const TriangleMesh m = shapes::sphere(6);
  const sphere::Distortion d = sphere::measure_distortion(m, delivered(m));
  CHECK(d.symmetric_dirichlet < 1.01);
  CHECK(d.quasi_conformal_mean < 1.1);
}

TEST_CASE("progress is monotonic and cancellation ends the work") {
  Recorder recorder;
  CHECK(sphere::embed_isometric(shapes::bumpy_sphere(4), Quality::high, 1, recorder).points.size() == 1026);
  for (const int reports : {1, 5, 20}) {
    CancelsAfter progress(reports);
    try {
      static_cast<void>(sphere::embed_isometric(shapes::bumpy_sphere(5), Quality::standard, 1, progress));
      FAIL("the embedding went on after it was canceled");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::canceled);
    }
  }
}
