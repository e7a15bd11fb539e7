#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "core/mesh/unit_positions.h"
#include "core/sphere/relaxation.h"
#include "core/sphere/sphere_math.h"
#include "core/sphere/star_table.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::Index;

namespace {

sphere::StarTable stars_of(const mesh::TriangleMesh& m, std::uint32_t threads = 1) {
  mesh::ThreadPool pool(threads);
  sphere::StarTable stars;
  stars.build(m.triangles, m.positions.size(), pool);
  return stars;
}

void check_stars(const mesh::TriangleMesh& m) {
  const sphere::StarTable stars = stars_of(m), again = stars_of(m, 3);
  std::size_t corners = 0;
  for (Index v = 0; v < m.positions.size(); ++v) {
    const auto star = stars[v];
    corners += star.size();
    for (std::size_t k = 0; k < star.size(); ++k) {
      const mesh::Triangle& t = m.triangles[star[k].triangle()];
      const std::size_t at = star[k].place();
      CHECK(t[at] == v);
      CHECK(t[(at + 1) % 3] == star[k].next);
      CHECK(t[(at + 2) % 3] == sphere::previous_in(star, k));
      CHECK(star[k].corner == again[v][k].corner);
    }
  }
  CHECK(corners == 3 * m.triangles.size());
}

} // namespace

TEST_CASE("stars list their triangles counter-clockwise, in one order for any number of threads") {
  check_stars(shapes::tetrahedron());
  check_stars(shapes::bipyramid(1000)); // its poles have stars of a thousand triangles
  check_stars(shapes::bumpy_sphere(5));
  for (std::uint64_t seed = 0; seed < 10; ++seed) check_stars(shapes::RandomTriangulation(seed).make(300, 2000));
}

TEST_CASE("no two vertices that a sweep may move at once are neighbours across blocks") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(6); // some 40,000 vertices, so some 20 blocks
  const sphere::StarTable stars = stars_of(m);
  mesh::ThreadPool pool(1);
  sphere::SweepOrder order;
  order.build(stars, pool);
  const auto block = [](Index v) { return v / sphere::SweepOrder::block_size; };
  std::vector<int> seen(m.positions.size());
  for (Index v = 0; v < m.positions.size(); ++v) {
    if (order.is_at_border(v)) continue;
    ++seen[v];
    for (const sphere::StarCorner& c : stars[v]) CHECK(block(c.next) == block(v));
  }
  for (std::size_t c = 0; c < order.classes(); ++c) {
    const std::set<Index> members(order.members(c).begin(), order.members(c).end());
    for (const Index v : members) {
      ++seen[v];
      CHECK(std::ranges::none_of(stars[v],
                                 [&](const sphere::StarCorner& corner) { return members.contains(corner.next); }));
    }
  }
  CHECK(std::ranges::count(seen, 1) == static_cast<std::ptrdiff_t>(seen.size()));
}

TEST_CASE("a sweep lowers the energy, and gives the same bits with any number of threads") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(6);
  const sphere::StarTable stars = stars_of(m);
  std::vector<Vec3d> start;
  for (const Vec3f& p : m.positions) start.push_back(normalized(Vec3d(p)));
  std::vector<std::vector<Vec3d>> results;
  for (const std::uint32_t threads : {1U, 2U, 5U}) {
    mesh::ThreadPool pool(threads);
    std::vector<sphere::Reference> references;
    sphere::compute_references(mesh::unit_positions(m), m.triangles, 1e-6, pool, references);
    sphere::SweepOrder order;
    order.build(stars, pool);
    std::vector<Vec3d> points = start;
    sphere::Active active(points.size(), 1);
    double energy = sphere::total_energy(sphere::SymmetricDirichlet{}, m.triangles, references, points, pool);
    for (int sweep = 0; sweep < 5; ++sweep) {
      CHECK(sphere::relax_active({stars, references, order}, sphere::SymmetricDirichlet{}, 1e-4, points, active, pool) >
            0);
      const double now = sphere::total_energy(sphere::SymmetricDirichlet{}, m.triangles, references, points, pool);
      CHECK(now < energy);
      energy = now;
    }
    results.push_back(std::move(points));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}
