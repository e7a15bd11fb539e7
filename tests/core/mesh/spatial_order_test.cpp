#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/mesh/spatial_order.h"
#include "core/mesh/unit_positions.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::Index;

namespace {

std::vector<Index> order_of(const mesh::TriangleMesh& m, std::uint32_t threads = 1) {
  mesh::ThreadPool pool(threads);
  return mesh::hilbert_order(mesh::unit_positions(m), pool);
}

std::vector<Index> shuffled(std::size_t n, std::uint32_t seed) {
  std::vector<Index> out(n);
  std::iota(out.begin(), out.end(), 0U);
  std::shuffle(out.begin(), out.end(), std::mt19937(seed));
  return out;
}

// The same surface with vertex order[i] called i, its triangles in another order and started at other corners.
mesh::TriangleMesh renumbered_at_random(const mesh::TriangleMesh& m, std::uint32_t seed) {
  const std::vector<Index> order = shuffled(m.positions.size(), seed);
  std::vector<Index> number(order.size());
  mesh::TriangleMesh out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    number[order[i]] = static_cast<Index>(i);
    out.positions.push_back(m.positions[order[i]]);
  }
  for (const Index t : shuffled(m.triangles.size(), seed + 1)) {
    mesh::Triangle moved{number[m.triangles[t][0]], number[m.triangles[t][1]], number[m.triangles[t][2]]};
    std::rotate(moved.begin(), moved.begin() + t % 3, moved.end());
    out.triangles.push_back(moved);
  }
  return out;
}

} // namespace

TEST_CASE("every vertex comes once, whatever the number of threads") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(6);
  std::vector<Index> order = order_of(m);
  CHECK(order == order_of(m, 3));
  std::ranges::sort(order);
  for (Index v = 0; v < order.size(); ++v) CHECK(order[v] == v);
}

TEST_CASE("the curve goes through all cells of a grid in steps of one") {
  // Centres of 8 x 8 x 8 cells of the unit cube.
  std::vector<Vec3d> centres;
  for (int i = 0; i < 512; ++i) centres.push_back({(i % 8 + 0.5) / 8, (i / 8 % 8 + 0.5) / 8, (i / 64 + 0.5) / 8});
  mesh::ThreadPool pool(1);
  const std::vector<Index> order = mesh::hilbert_order(centres, pool);
  for (std::size_t i = 1; i < order.size(); ++i)
    CHECK(norm(centres[order[i]] - centres[order[i - 1]]) == doctest::Approx(0.125));
}

TEST_CASE("the renumbered mesh does not depend on the numbering it came with") {
  const mesh::TriangleMesh m = shapes::bumpy_sphere(4);
  mesh::ThreadPool pool(2);
  const std::vector<mesh::Triangle> expected = mesh::renumbered(m.triangles, order_of(m), pool);
  CHECK(std::ranges::is_sorted(expected));
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const mesh::TriangleMesh other = renumbered_at_random(m, seed);
    CHECK(mesh::renumbered(other.triangles, order_of(other), pool) == expected);
  }
}

TEST_CASE("meshes without extent and single vertices keep their order") {
  mesh::ThreadPool pool(1);
  const std::vector<Vec3d> points(5);
  CHECK(mesh::hilbert_order(points, pool) == std::vector<Index>{0, 1, 2, 3, 4});
  CHECK(mesh::hilbert_order({}, pool).empty());
}
