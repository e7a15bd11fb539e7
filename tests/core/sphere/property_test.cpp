// Properties of every mesh, on random ones. rapidcheck shrinks what fails; RC_PARAMS="seed=… max_success=…" asks for
// others than the fixed ones.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "core/mesh/unit_positions.h"
#include "core/sphere/canonical_turn.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"
#include "core/sphere/embedding.h"
#include "core/sphere/hierarchy.h"
#include "core/sphere/newton_level.h"
#include "core/sphere/relaxation.h"
#include "core/sphere/snap.h"
#include "support/random_mesh.h"

using namespace orbis;
using mesh::TriangleMesh;
using shapes::RandomMesh;

namespace {

// Before rapidcheck reads it for the first time.
const int parameters = setenv("RC_PARAMS", "seed=20040101 max_success=25", 0);

// Sizes from 4 vertices to `most`, evenly by their logarithm.
rc::Gen<RandomMesh> random_mesh(double most) {
  return rc::gen::map(rc::gen::tuple(rc::gen::inRange<std::uint64_t>(0, 1'000'000), rc::gen::inRange(0, 1000),
                                     rc::gen::inRange<std::uint32_t>(0, 10),
                                     rc::gen::inRange<std::uint32_t>(0, RandomMesh::position_kinds)),
                      [most](const auto& t) {
                        const auto vertices =
                            static_cast<std::uint32_t>(4 * std::pow(most / 4, std::get<1>(t) / 999.0));
                        return RandomMesh{std::get<0>(t), vertices, std::get<2>(t), std::get<3>(t)};
                      });
}

std::vector<Vec3f> delivered(std::span<const Vec3d> points, const TriangleMesh& m) {
  std::vector<Vec3f> out;
  for (const sphere::GridPoint& p : sphere::snap(points, m.triangles).points) out.push_back(sphere::from_grid(p));
  return out;
}

std::vector<Vec3d> embedded(const TriangleMesh& m, Objective objective = Objective::isometric) {
  NoProgress progress;
  NoCheckpoints none;
  Options options;
  options.objective = objective;
  return sphere::canonically_turned(m, sphere::embed(m, options, 1, progress, none).points);
}

double distortion(const TriangleMesh& m) {
  return sphere::measure_distortion(m, delivered(embedded(m), m)).symmetric_dirichlet;
}

bool within_a_hundredth(double a, double b) { return std::abs(a - b) < 0.01 * b; }

} // namespace

TEST_CASE("property: splits undo collapses bit for bit") {
  CHECK(rc::check([] {
    const TriangleMesh m = (*random_mesh(10'000)).make();
    NoProgress progress;
    mesh::ThreadPool pool(1);
    sphere::Hierarchy h = sphere::build_hierarchy(m, pool, progress);
    for (std::size_t i = h.removed.size(); i-- > 0;) h.undo(i);
    // Up to where each triangle starts.
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      mesh::Triangle turned = h.triangles[t];
      std::ranges::rotate(turned, std::ranges::find(turned, m.triangles[t][0]));
      RC_ASSERT(turned == m.triangles[t]);
    }
  }));
}

TEST_CASE("property: every closed genus-0 mesh gets a certified map") {
  CHECK(rc::check([] {
    const RandomMesh mesh = *random_mesh(10'000);
    RC_LOG() << mesh;
    const TriangleMesh m = mesh.make();
    const Objective objective =
        *rc::gen::element(Objective::isometric, Objective::isometric, Objective::conformal, Objective::stretch);
    RC_ASSERT(sphere::certify(delivered(embedded(m, objective), m), m.triangles).failure() == "");
  }));
}

TEST_CASE("property: the energy never rises in a step") {
  CHECK(rc::check([] {
    const TriangleMesh m = (*random_mesh(1'000)).make();
    const sphere::TriangleEnergy energy = *rc::gen::element<sphere::TriangleEnergy>(
        sphere::SymmetricDirichlet{}, sphere::Stretch{}, sphere::AreaWeighted{0.3});
    NoProgress progress;
    NoCheckpoints none;
    std::vector<Vec3d> points = sphere::embed_by_energy(m, energy, Quality::draft, 1, progress, none).points;
    mesh::ThreadPool pool(1);
    std::vector<sphere::Reference> references;
    sphere::compute_references(mesh::unit_positions(m), m.triangles, 1e-6, pool, references);
    sphere::StarTable stars;
    stars.build(m.triangles, points.size(), pool);
    sphere::SweepOrder order;
    order.build(stars, pool);
    const sphere::WholeLevel level{energy, m.triangles, stars, references};
    sphere::NewtonLevel newton(level, false, pool);
    const auto value = [&] { return sphere::total_energy(energy, m.triangles, references, points, pool); };
    double before = value();
    for (int i = 0; i < 4; ++i) {
      sphere::Active active(points.size(), 1);
      sphere::relax_active({stars, references, order}, energy, 0, points, active, pool);
      const double swept = value();
      RC_ASSERT(swept <= before * (1 + 1e-12)); // the sums round in different orders
      static_cast<void>(newton.take(points));
      before = value();
      RC_ASSERT(before <= swept);
    }
  }));
}

TEST_CASE("property: the order of vertices and faces does not matter") {
  CHECK(rc::check([] {
    const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
    const TriangleMesh m = shapes::random_blob(seed, 4);
    std::mt19937_64 random(seed);
    std::vector<mesh::Index> place(m.positions.size());
    std::iota(place.begin(), place.end(), 0U);
    std::ranges::shuffle(place, random);
    TriangleMesh shuffled{std::vector<Vec3f>(m.positions.size()), m.triangles};
    for (std::size_t v = 0; v < place.size(); ++v) shuffled.positions[place[v]] = m.positions[v];
    for (mesh::Triangle& t : shuffled.triangles) t = {place[t[1]], place[t[2]], place[t[0]]};
    std::ranges::shuffle(shuffled.triangles, random);
    RC_ASSERT(within_a_hundredth(distortion(shuffled), distortion(m)));
  }));
}

TEST_CASE("property: size, place and direction of the model do not matter") {
  CHECK(rc::check([] {
    const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
    const TriangleMesh m = shapes::random_blob(seed, 4);
    std::mt19937_64 random(seed + 1);
    std::normal_distribution<float> normal;
    const float scale = std::exp(5 * normal(random));
    const Eigen::Matrix3f turn =
        Eigen::Quaternionf(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
    const Eigen::Vector3f shift = 10 * scale * Eigen::Vector3f(normal(random), normal(random), normal(random));
    TriangleMesh moved = m;
    for (Vec3f& p : moved.positions) {
      const Eigen::Vector3f q = turn * (scale * Eigen::Vector3f(p.x, p.y, p.z)) + shift;
      p = {q.x(), q.y(), q.z()};
    }
    RC_ASSERT(within_a_hundredth(distortion(moved), distortion(m)));
  }));
}

TEST_CASE("property: a mirrored model gets a mirrored map") {
  CHECK(rc::check([] {
    const TriangleMesh m = shapes::random_blob(*rc::gen::inRange<std::uint64_t>(0, 1'000'000), 4);
    TriangleMesh mirrored = m;
    for (Vec3f& p : mirrored.positions) p.x = -p.x;
    for (mesh::Triangle& t : mirrored.triangles) std::swap(t[1], t[2]);
    RC_ASSERT(within_a_hundredth(distortion(mirrored), distortion(m)));
    const std::vector<Vec3d> points = embedded(m), image = embedded(mirrored);
    double apart = 0; // on the mean, in radians
    for (std::size_t v = 0; v < points.size(); ++v) {
      apart += norm(points[v] - Vec3d{-image[v].x, image[v].y, image[v].z}) / static_cast<double>(points.size());
    }
    RC_ASSERT(apart < 0.05);
  }));
}
