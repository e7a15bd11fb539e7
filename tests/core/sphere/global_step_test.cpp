#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "core/mesh/unit_positions.h"
#include "core/sphere/global_step.h"
#include "core/sphere/newton_level.h"
#include "core/sphere/relaxation.h"
#include "support/shapes.h"

using namespace orbis;
using sphere::Tangent;

namespace {

// A convex mesh on its own sphere: not where the energy is least, but without a fold.
struct Scene {
  explicit Scene(const mesh::TriangleMesh& m, std::uint32_t threads = 1,
                 const sphere::TriangleEnergy& of = sphere::SymmetricDirichlet{})
      : pool(threads), energy_of(of), mesh(m) {
    NoProgress progress;
    hierarchy = sphere::build_hierarchy(mesh, pool, progress);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) points.push_back(normalized(Vec3d(mesh.positions[v])));
    stars.build(mesh.triangles, points.size(), pool);
    sphere::compute_references(mesh::unit_positions(mesh), mesh.triangles, 1e-6, pool, references);
    basis.emplace(hierarchy, pool);
    std::vector<sphere::StarTerm> star;
    for (mesh::Index v = 0; v < points.size(); ++v) {
      sphere::gather_star(v, stars, references, points, star);
      const sphere::TangentFrame frame(points[v]);
      basis->keep_stiffness(
          v, std::visit([&](const auto& e) { return sphere::expand(e, star, points[v], frame); }, energy_of),
          points[v]);
    }
    basis->prepare(points);
  }

  [[nodiscard]] sphere::WholeLevel level() const { return {energy_of, mesh.triangles, stars, references}; }
  [[nodiscard]] double energy() { return sphere::total_energy(energy_of, mesh.triangles, references, points, pool); }

  mesh::ThreadPool pool;
  sphere::TriangleEnergy energy_of;
  mesh::TriangleMesh mesh;
  sphere::Hierarchy hierarchy;
  sphere::StarTable stars;
  std::vector<sphere::Reference> references;
  std::vector<Vec3d> points;
  std::optional<sphere::HierarchicalBasis> basis;
};

mesh::TriangleMesh ellipsoid(int levels) {
  mesh::TriangleMesh m = shapes::sphere(levels);
  for (Vec3f& p : m.positions) p = {2.5F * p.x, p.y, 0.7F * p.z};
  return m;
}

std::vector<Tangent> random_field(std::size_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Tangent> out(n);
  for (Tangent& t : out) {
    t.x = normal(random);
    t.y = normal(random);
  }
  return out;
}

double inner(const std::vector<Tangent>& a, const std::vector<Tangent>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].x * b[i].x + a[i].y * b[i].y;
  return sum;
}

} // namespace

TEST_CASE("the preconditioner is symmetric and positive definite") {
  Scene scene(ellipsoid(4));
  const std::size_t n = scene.points.size();
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const std::vector<Tangent> a = random_field(n, seed), b = random_field(n, seed + 100);
    std::vector<Tangent> ma(n), mb(n);
    scene.basis->apply(a, ma);
    scene.basis->apply(b, mb);
    CHECK(inner(ma, b) == doctest::Approx(inner(a, mb)).epsilon(1e-5)); // its weights are floats
    CHECK(inner(ma, a) > 0);
  }
}

TEST_CASE("the Hessian is symmetric and positive semi-definite") {
  Scene scene(ellipsoid(4));
  const std::size_t n = scene.points.size();
  sphere::TangentHessian hessian;
  hessian.build(scene.energy_of, scene.stars, scene.references, scene.points, 0, scene.pool);
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const std::vector<Tangent> a = random_field(n, seed), b = random_field(n, seed + 100);
    std::vector<Tangent> ha(n), hb(n);
    hessian.apply(a, ha, scene.pool);
    hessian.apply(b, hb, scene.pool);
    CHECK(inner(ha, b) == doctest::Approx(inner(a, hb)).epsilon(1e-4));
    CHECK(inner(ha, a) > 0);
  }
}

TEST_CASE("what the sparse factorisation solves, multiplied by the matrix, is the right side again") {
  for (const mesh::TriangleMesh& m : {shapes::tetrahedron(), shapes::sphere(0), ellipsoid(2), ellipsoid(5)}) {
    Scene scene(m);
    const std::size_t n = scene.points.size();
    CAPTURE(n);
    sphere::TangentHessian hessian;
    hessian.build(scene.energy_of, scene.stars, scene.references, scene.points, 0, scene.pool);
    std::vector<double> shifts(n);
    for (std::size_t v = 0; v < n; ++v) shifts[v] = 0.01 * (1 + static_cast<double>(v % 7));
    sphere::BlockCholesky solver(scene.stars);
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      for (double& shift : shifts) shift *= 1.5; // it is factorised anew
      REQUIRE(solver.factorise(hessian, shifts));
      const std::vector<Tangent> right = random_field(n, seed);
      std::vector<Tangent> x = right, product(n);
      solver.solve(x);
      hessian.apply(x, product, scene.pool);
      for (std::size_t v = 0; v < n; ++v) {
        // The Hessian's blocks are floats, rounded on each side of the diagonal by themselves.
        CHECK(std::abs(product[v].x + shifts[v] * x[v].x - right[v].x) < 1e-4);
        CHECK(std::abs(product[v].y + shifts[v] * x[v].y - right[v].y) < 1e-4);
      }
    }
  }
}

TEST_CASE("a matrix that is not positive definite is not factorised") {
  Scene scene(ellipsoid(3));
  sphere::TangentHessian hessian;
  hessian.build(scene.energy_of, scene.stars, scene.references, scene.points, 0, scene.pool);
  std::vector<double> shifts(scene.points.size(), 0.01);
  sphere::BlockCholesky solver(scene.stars);
  CHECK(solver.factorise(hessian, shifts));
  shifts[100] = -1e6;
  CHECK(!solver.factorise(hessian, shifts));
}

TEST_CASE("where nothing is indefinite, the Hessian is the derivative of the gradient") {
  // On a sphere mapped to itself every triangle is nearly isometric, and the twist's eigenvalue nearly 0.
  Scene scene(shapes::sphere(5));
  const std::size_t n = scene.points.size();
  sphere::TangentHessian hessian;
  hessian.build(scene.energy_of, scene.stars, scene.references, scene.points, 0, scene.pool);
  // A smooth field, small against the triangles.
  std::vector<Tangent> field(n), image(n), before(n), after(n);
  const auto moved = [&](double t) {
    std::vector<Vec3d> points = scene.points;
    for (std::size_t v = 0; v < n; ++v) {
      const Vec3d& p = scene.points[v];
      const Vec3d d{p.y * p.z, p.x * p.x, -p.x * p.y};
      const sphere::TangentFrame f(p);
      field[v] = {dot(d, f.x), dot(d, f.y)};
      points[v] = normalized(p + (t * field[v].x) * f.x + (t * field[v].y) * f.y);
    }
    return points;
  };
  const double t = 1e-4;
  sphere::tangent_gradient(scene.energy_of, scene.stars, scene.references, moved(-t), before, scene.pool);
  sphere::tangent_gradient(scene.energy_of, scene.stars, scene.references, moved(t), after, scene.pool);
  hessian.apply(field, image, scene.pool);
  double along = 0;
  for (std::size_t v = 0; v < n; ++v) {
    along += field[v].x * (after[v].x - before[v].x) / (2 * t) + field[v].y * (after[v].y - before[v].y) / (2 * t);
  }
  // The bend of the sphere, which the Hessian leaves out, and the frames' turn account for the rest.
  CHECK(inner(field, image) == doctest::Approx(along).epsilon(0.25));
}

TEST_CASE("the exact Hessian is the derivative of the gradient") {
  for (const sphere::TriangleEnergy& energy : std::array<sphere::TriangleEnergy, 3>{
           sphere::SymmetricDirichlet{}, sphere::Stretch{}, sphere::AreaWeighted{0.3}}) {
    CAPTURE(energy.index());
    Scene scene(ellipsoid(4), 1, energy);
    const std::size_t n = scene.points.size();
    const std::vector<Tangent> a = random_field(n, 1), b = random_field(n, 2);
    sphere::TangentHessian hessian;
    hessian.build(energy, scene.stars, scene.references, scene.points, 1, scene.pool);
    std::vector<Tangent> image(n);
    hessian.apply(a, image, scene.pool);
    const auto energy_at = [&](double s, double t) {
      std::vector<Vec3d> moved;
      for (std::size_t v = 0; v < n; ++v) {
        const sphere::TangentFrame f(scene.points[v]);
        moved.push_back(
            normalized(scene.points[v] + (s * a[v].x + t * b[v].x) * f.x + (s * a[v].y + t * b[v].y) * f.y));
      }
      return sphere::total_energy(energy, scene.mesh.triangles, scene.references, moved, scene.pool);
    };
    const double h = 2e-5;
    const double mixed = (energy_at(h, h) - energy_at(h, -h) - energy_at(-h, h) + energy_at(-h, -h)) / (4 * h * h);
    const double straight = (energy_at(h, 0) - 2 * energy_at(0, 0) + energy_at(-h, 0)) / (h * h);
    CHECK(inner(image, a) == doctest::Approx(straight).epsilon(1e-3));
    CHECK(std::abs(inner(image, b) - mixed) < 1e-3 * std::abs(straight));
  }
}

TEST_CASE("Newton's method converges, its steps never raise the energy, and its promises are kept") {
  for (const sphere::TriangleEnergy& energy : std::array<sphere::TriangleEnergy, 3>{
           sphere::SymmetricDirichlet{}, sphere::Stretch{}, sphere::AreaWeighted{0.3}}) {
    CAPTURE(energy.index());
    Scene scene(ellipsoid(4), 1, energy);
    const sphere::WholeLevel level = scene.level();
    sphere::NewtonLevel newton(level, false, scene.pool);
    double value = scene.energy(), promise = 1;
    for (int i = 0; i < 60 && promise > 1e-7; ++i) {
      promise = newton.take(scene.points);
      CHECK(promise >= 0);
      const double now = scene.energy();
      CHECK(now <= value);
      value = now;
    }
    CHECK(promise <= 1e-7);
    // At the minimum nothing is left for local steps either.
    sphere::SweepOrder order;
    order.build(scene.stars, scene.pool);
    sphere::Active active(scene.points.size(), 1);
    sphere::relax_active({scene.stars, scene.references, order}, energy, 1e-9, scene.points, active, scene.pool);
    CHECK(scene.energy() > value * (1 - 1e-5));
  }
}

TEST_CASE("a step lowers the energy, folds nothing and comes to an end") {
  Scene scene(ellipsoid(5));
  sphere::GlobalStep global(scene.level(), *scene.basis, scene.pool);
  double energy = scene.energy();
  const double first = energy;
  double gain = 1;
  for (int i = 0; i < 40 && gain > 1e-4; ++i) {
    gain = global.take(30, scene.points).gain;
    const double now = scene.energy();
    CHECK(now <= energy);
    energy = now;
  }
  CHECK(gain <= 1e-4);
  CHECK(energy < 0.9 * first);
  CHECK(std::isfinite(energy));
}

TEST_CASE("the bits do not depend on the number of threads") {
  Scene one(ellipsoid(5), 1), four(ellipsoid(5), 4);
  sphere::GlobalStep in_one(one.level(), *one.basis, one.pool), in_four(four.level(), *four.basis, four.pool);
  CHECK(in_one.take(20, one.points).gain == in_four.take(20, four.points).gain);
  CHECK(one.points == four.points);
}
