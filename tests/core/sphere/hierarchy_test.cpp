#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "core/mesh/topology.h"
#include "core/sphere/hierarchy.h"
#include "support/shapes.h"

using namespace orbis;
using mesh::TriangleMesh;

namespace {

sphere::Hierarchy hierarchy_of(const TriangleMesh& m) {
  NoProgress progress;
  mesh::ThreadPool pool(1);
  return sphere::build_hierarchy(m, pool, progress);
}

// The triangles that are live before removal i is undone, and after: found by replaying.
void check_every_level(const TriangleMesh& m) {
  sphere::Hierarchy h = hierarchy_of(m);
  std::set<std::uint32_t> live(h.tetrahedron_slots.begin(), h.tetrahedron_slots.end());
  CHECK(h.removed.size() == m.positions.size() - 4);
  for (std::size_t round = h.rounds(); round-- > 0;) {
    std::set<mesh::Index> removed(h.removed.begin() + h.round_first[round],
                                  h.removed.begin() + h.round_first[round + 1]);
    for (std::uint32_t i = h.round_first[round]; i < h.round_first[round + 1]; ++i) {
      CHECK(std::ranges::none_of(h.ring(i), [&](mesh::Index v) { return removed.contains(v); }));
      h.undo(i);
      live.insert(h.slots(i).begin(), h.slots(i).end());
    }
    TriangleMesh level{m.positions, {}};
    for (const std::uint32_t s : live) level.triangles.push_back(h.triangles[s]);
    CHECK(mesh::classify(level).is_sphere());
    CHECK(mesh::classify(level).consistently_oriented);
  }
  // Up to where each triangle starts, the mesh is what it was.
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    mesh::Triangle turned = h.triangles[t];
    std::ranges::rotate(turned, std::ranges::find(turned, m.triangles[t][0]));
    CHECK(turned == m.triangles[t]);
  }
}

} // namespace

TEST_CASE("insertions undo removals, and every level between is a sphere") {
  check_every_level(shapes::tetrahedron());
  check_every_level(shapes::bipyramid(3));
  check_every_level(shapes::bipyramid(200));
  check_every_level(shapes::bumpy_sphere(4));
  check_every_level(shapes::tube(50, 4, 10));
  for (std::uint64_t seed = 0; seed < 20; ++seed) check_every_level(shapes::RandomTriangulation(seed).make(300, 2000));
}

TEST_CASE("rounds shrink the mesh geometrically") {
  const TriangleMesh m = shapes::sphere(6);
  CHECK(hierarchy_of(m).rounds() < 60);
}

TEST_CASE("the hierarchy does not depend on the number of threads") {
  NoProgress progress;
  mesh::ThreadPool one(1), three(3);
  const TriangleMesh m = shapes::bumpy_sphere(6);
  const sphere::Hierarchy a = sphere::build_hierarchy(m, one, progress),
                          b = sphere::build_hierarchy(m, three, progress);
  CHECK(a.removed == b.removed);
  CHECK(a.ring_vertices == b.ring_vertices);
}
