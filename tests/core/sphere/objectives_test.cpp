#include <doctest/doctest.h>

#include <cmath>

#include "core/mesh/unit_positions.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"
#include "core/sphere/embedding.h"
#include "core/sphere/moebius_centring.h"
#include "core/sphere/shape_preserving_placement.h"
#include "core/sphere/snap.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::TriangleMesh;

namespace {

Options with(Objective objective, double area_weight = 1) {
  Options options;
  options.objective = objective;
  options.area_weight = area_weight;
  options.threads = 1;
  return options;
}

std::vector<Vec3f> delivered(const TriangleMesh& m, const Options& options) {
  NoProgress progress;
  NoCheckpoints none;
  const sphere::Snapped snapped =
      sphere::snap(sphere::embed(m, options, options.threads, progress, none).points, m.triangles);
  std::vector<Vec3f> out;
  for (const sphere::GridPoint& p : snapped.points) out.push_back(sphere::from_grid(p));
  return out;
}

sphere::Distortion distortion(const TriangleMesh& m, const Options& options) {
  return sphere::measure_distortion(m, delivered(m, options));
}

// A sphere with four limbs, long enough for conformal maps to be in trouble.
TriangleMesh with_limbs(float length) {
  TriangleMesh m = shapes::sphere(5);
  for (Vec3f& p : m.positions) {
    for (const Vec3f& d :
         {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, normalized(Vec3f{-1, -1, 1}), normalized(Vec3f{-1, -1, -1})}) {
      const float height = dot(normalized(p), d) - 0.95F;
      if (height > 0) p += d * (height * 20 * length);
    }
  }
  return m;
}

} // namespace

TEST_CASE("every objective gives a certified map") {
  const std::vector<Options> all{with(Objective::isometric),       with(Objective::isometric, 0.7),
                                 with(Objective::isometric, 0.1),  with(Objective::isometric, 0),
                                 with(Objective::conformal),       with(Objective::stretch),
                                 with(Objective::shape_preserving)};
  const std::vector<TriangleMesh> meshes{shapes::tetrahedron(),   shapes::bipyramid(3),      shapes::bipyramid(1000),
                                         shapes::bumpy_sphere(4), shapes::tube(100, 6, 300), with_limbs(4)};
  for (const Options& options : all) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      CAPTURE(get_option(options, "objective"));
      CAPTURE(options.area_weight);
      CAPTURE(i);
      CHECK(sphere::certify(delivered(meshes[i], options), meshes[i].triangles).failure() == "");
    }
  }
}

TEST_CASE("each objective is best at what it minimises, and the weight is a dial between angles and areas") {
  const TriangleMesh m = shapes::bumpy_sphere(5);
  const sphere::Distortion isometric = distortion(m, with(Objective::isometric)),
                           half = distortion(m, with(Objective::isometric, 0.4)),
                           conformal = distortion(m, with(Objective::conformal)),
                           stretch = distortion(m, with(Objective::stretch));
  CHECK(isometric.symmetric_dirichlet < half.symmetric_dirichlet);
  CHECK(half.symmetric_dirichlet < conformal.symmetric_dirichlet);
  CHECK(isometric.symmetric_dirichlet < stretch.symmetric_dirichlet);
  CHECK(conformal.quasi_conformal_mean < half.quasi_conformal_mean);
  CHECK(half.quasi_conformal_mean < isometric.quasi_conformal_mean);
  CHECK(conformal.quasi_conformal_mean < 1.1);
  CHECK(isometric.log_area_deviation < half.log_area_deviation);
  CHECK(half.log_area_deviation < conformal.log_area_deviation);
  CHECK(stretch.l2_stretch < isometric.l2_stretch);
}

TEST_CASE("an area weight of 0 is the conformal objective") {
  const TriangleMesh m = shapes::bumpy_sphere(4);
  CHECK(delivered(m, with(Objective::isometric, 0)) == delivered(m, with(Objective::conformal)));
}

TEST_CASE("limbs stay large enough to tell their vertices apart") {
  const TriangleMesh m = with_limbs(30);
  const sphere::Distortion d = distortion(m, with(Objective::conformal));
  CHECK(d.log_area_deviation > 2); // conformal all the same
  CHECK(d.smallest_area > 1e-12);
}

TEST_CASE("centring undoes any Moebius map: what is left is the least area distortion") {
  const TriangleMesh m = shapes::sphere(5);
  mesh::ThreadPool pool(1);
  std::vector<sphere::Reference> references;
  sphere::compute_references(mesh::unit_positions(m), m.triangles, 1e-6, pool, references);
  std::vector<Vec3d> own;
  for (const Vec3f& p : m.positions) own.push_back(normalized(Vec3d(p)));
  const auto centred = [&](std::vector<Vec3d> points) {
    return sphere::centre_by_moebius(m.triangles, references, points, pool);
  };
  const double least = centred(own);
  for (const Vec3d& a : {Vec3d{0.3, 0, 0}, Vec3d{-0.2, 0.5, 0.4}, Vec3d{0, 0, 0.85}}) {
    std::vector<Vec3d> moved;
    for (const Vec3d& p : own) moved.push_back(sphere::moebius(p, a));
    CHECK(centred(moved) == doctest::Approx(least).epsilon(1e-3));
  }
}

TEST_CASE("the objectives do not depend on the number of threads") {
  const TriangleMesh m = shapes::bumpy_sphere(6);
  for (const Objective objective : {Objective::conformal, Objective::stretch}) {
    Options one = with(objective), three = one;
    three.threads = 3;
    CHECK(delivered(m, one) == delivered(m, three));
  }
}
