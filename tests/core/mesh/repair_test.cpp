// What must be true of every soup: it comes out as spheres, each of its triangles once.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "support/defects.h"

using namespace orbis;
using namespace orbis::mesh;

namespace {

TriangleMesh piece_of(const Repaired& r, const ClosedPiece& p) {
  TriangleMesh out;
  out.positions.assign(r.mesh.positions.begin() + p.first_vertex,
                       r.mesh.positions.begin() + p.first_vertex + p.vertices);
  for (std::uint32_t t = p.first_triangle; t < p.first_triangle + p.triangles; ++t) {
    Triangle local = r.mesh.triangles[t];
    for (Index& v : local) v -= p.first_vertex;
    out.triangles.push_back(local);
  }
  return out;
}

bool has_double_edge(const TriangleMesh& m) {
  std::set<std::pair<Index, Index>> sides;
  for (const Triangle& t : m.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!sides.insert({t[k], t[(k + 1) % 3]}).second) return true;
    }
  }
  return false;
}

// Every piece is a sphere, ready to be unfolded; every triangle of the soup is there once, with its own points.
void check_spheres(const TriangleMesh& soup, const Repaired& r) {
  std::vector<int> count(soup.triangles.size(), 0);
  for (const ClosedPiece& p : r.pieces) {
    const TriangleMesh piece = piece_of(r, p);
    const Topology t = classify(piece);
    CHECK_MESSAGE(t.is_sphere(), t.refusal());
    CHECK(t.consistently_oriented);
    CHECK(t.vertices == p.vertices);
    CHECK_FALSE(has_double_edge(piece));
    CHECK(p.soup_triangles > 0);
    for (std::uint32_t i = 0; i < p.triangles; ++i) {
      const std::uint32_t source = r.triangle_of[p.first_triangle + i];
      CHECK((source == added_triangle) == (i >= p.soup_triangles));
      if (source == added_triangle) continue;
      ++count[source];
      Triangle points{}, expected = soup.triangles[source];
      for (std::size_t k = 0; k < 3; ++k) {
        points[k] = r.point_of[r.mesh.triangles[p.first_triangle + i][k]];
        CHECK(r.mesh.positions[r.mesh.triangles[p.first_triangle + i][k]] == soup.positions[points[k]]);
      }
      if (r.turned[source]) std::swap(expected[1], expected[2]);
      CHECK(points == expected);
    }
  }
  CHECK(std::ranges::all_of(count, [](int n) { return n == 1; }));
}

Repaired repaired(const TriangleMesh& soup, double tolerance = 0) {
  Repaired out = repair(soup.positions, soup.triangles, soup.triangles, tolerance);
  check_spheres(soup, out);
  return out;
}

std::uint64_t handles_of(const Repaired& r) {
  std::uint64_t sum = 0;
  for (const ClosedPiece& p : r.pieces) sum += p.handles.loops;
  return sum;
}

} // namespace

TEST_CASE("a sphere is left as it is") {
  const TriangleMesh m = shapes::bumpy_sphere(3);
  const Repaired r = repaired(m);
  REQUIRE(r.pieces.size() == 1);
  CHECK(r.mesh.triangles.size() == m.triangles.size());
  CHECK(r.pieces[0].boundary_loops == 0);
  CHECK(std::ranges::count(r.turned, true) == 0);
}

TEST_CASE("open surfaces are capped, one cap a boundary loop") {
  struct Open {
    TriangleMesh mesh;
    std::uint32_t loops;
  };
  const TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const Open& open :
       {Open{triangle, 1}, Open{shapes::terrain(1, 1), 1}, Open{shapes::disk(5, 12), 1}, Open{shapes::disk(1, 500), 1},
        Open{shapes::annulus(4, 20), 2}, Open{shapes::annulus(2, 3), 2}, Open{shapes::terrain(30, 20, 1), 1},
        Open{shapes::holed_terrain(11, 7), 16}, Open{shapes::strip(40, 3, 2), 2}, Open{shapes::strip(40, 1, 0), 2}}) {
    const Repaired r = repaired(open.mesh);
    REQUIRE(r.pieces.size() == 1);
    CHECK(r.pieces[0].boundary_loops == open.loops);
    CHECK(r.pieces[0].genus == 0);
  }
}

TEST_CASE("a handle is cut along one loop, and as many loops are cut as there are handles") {
  for (const auto& [n, m] : {std::pair<Index, Index>{10, 6}, {40, 12}, {3, 3}}) {
    const Repaired r = repaired(shapes::torus(n, m));
    REQUIRE(r.pieces.size() == 1);
    CHECK(r.pieces[0].genus == 1);
    CHECK(r.pieces[0].handles.loops == 1);
  }
  for (const int holes : {1, 2, 5, 40}) {
    const Repaired r = repaired(shapes::plate_with_holes(holes));
    REQUIRE(r.pieces.size() == 1);
    CHECK(r.pieces[0].genus == static_cast<std::uint32_t>(holes));
    CHECK(r.pieces[0].handles.loops == static_cast<std::uint64_t>(holes));
    // Around a bar, or around a hole: no more than 4 cube sides, 4 with diagonals cut off.
    CHECK(r.pieces[0].handles.length <= 4.001 * holes);
  }
}

TEST_CASE("a torus with holes and a handle on the boundary is cut and capped") {
  TriangleMesh m = shapes::torus(24, 10);
  for (std::size_t t = 0; t < m.triangles.size(); t += 37)
    std::swap(m.triangles[t], m.triangles.back()), m.triangles.pop_back();
  const Repaired r = repaired(m);
  CHECK(handles_of(r) == 1);
}

TEST_CASE("one-sided surfaces are cut until they have two sides") {
  for (const int half_turns : {1, 3}) {
    for (const Index wide : {1U, 4U}) {
      const Repaired r = repaired(shapes::strip(50, wide, half_turns));
      REQUIRE(r.pieces.size() == 1);
      CHECK(r.counts.one_sided_edges >= wide);
      CHECK(r.counts.one_sided_edges <= 3 * wide);
    }
  }
  const Repaired klein = repaired(shapes::klein_bottle(30, 16));
  CHECK(klein.pieces.size() == 1);
  CHECK(klein.counts.one_sided_edges > 0);
}

TEST_CASE("what touches in a vertex or an edge comes apart") {
  const TriangleMesh edge = shapes::voxels({{0, 0, 0}, {1, 1, 0}}), corner = shapes::voxels({{0, 0, 0}, {1, 1, 1}});
  for (const TriangleMesh& m : {edge, corner}) {
    const Repaired r = repaired(m);
    REQUIRE(r.pieces.size() == 2);
    CHECK(r.pieces[0].triangles == 12);
    CHECK(r.pieces[1].triangles == 12);
    CHECK(r.pieces[0].boundary_loops == 0);
  }
  CHECK(repaired(edge).counts.shared_edges == 1);
  CHECK(repaired(edge).counts.split_vertices == 2);
  CHECK(repaired(corner).counts.split_vertices == 1);
}

TEST_CASE("a wall in a body is a piece of its own, and told") {
  TriangleMesh m = shapes::voxels({{0, 0, 0}, {1, 0, 0}});
  const auto at = [&](float y, float z) {
    return static_cast<Index>(std::ranges::find(m.positions, Vec3f{1, y, z}) - m.positions.begin());
  };
  m.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
  m.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
  const Repaired r = repaired(m);
  REQUIRE(r.pieces.size() == 2);
  CHECK(r.pieces[0].triangles == 20);
  CHECK(r.pieces[0].boundary_loops == 0);
  CHECK(r.counts.internal_triangles == 2);
}

TEST_CASE("a sheet with two sides is two sheets, and without volume but cut otherwise on its back it is one body") {
  for (TriangleMesh sheet : {shapes::terrain(4, 3), shapes::terrain(1, 1)}) {
    const std::size_t front = sheet.triangles.size();
    for (std::size_t t = 0; t < front; ++t) {
      const Triangle s = sheet.triangles[t];
      sheet.triangles.push_back({s[0], s[2], s[1]});
    }
    const Repaired r = repaired(sheet);
    REQUIRE(r.pieces.size() == 2);
    CHECK(r.pieces[0].soup_triangles == front);
    CHECK(r.pieces[1].boundary_loops == 1);
    CHECK(r.counts.internal_triangles == 0);
  }
  TriangleMesh quad = shapes::terrain(1, 1);
  quad.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 2}, {1, 3, 2}}; // the other diagonal on its back: a flat tetrahedron
  const Repaired flat = repaired(quad);
  REQUIRE(flat.pieces.size() == 1);
  CHECK(flat.pieces[0].boundary_loops == 0);
}

TEST_CASE("flipped faces are turned back, the fewer of an open piece and outward of a closed one") {
  TriangleMesh open = shapes::terrain(9, 9), closed = shapes::bumpy_sphere(3);
  for (std::size_t t = 0; t < open.triangles.size(); t += 4) std::swap(open.triangles[t][0], open.triangles[t][1]);
  for (std::size_t t = 0; t < closed.triangles.size(); ++t) {
    if (t % 5 != 0) std::swap(closed.triangles[t][0], closed.triangles[t][1]);
  }
  const Repaired flat = repaired(open), round = repaired(closed);
  CHECK(flat.pieces[0].turned_triangles == (open.triangles.size() + 3) / 4);
  CHECK(round.pieces[0].turned_triangles == closed.triangles.size() - (closed.triangles.size() + 4) / 5);
  CHECK(classify(piece_of(round, round.pieces[0])).signed_volume > 0);
}

TEST_CASE("cracks at T-junctions are closed, so that the sheets stay one") {
  const TriangleMesh m = shapes::t_junction_grid(6);
  const Welded welded = weld(m.positions, m.triangles);
  const Repaired r = repaired(welded.mesh);
  REQUIRE(r.pieces.size() == 1);
  CHECK(r.pieces[0].crack_triangles == 6);
  CHECK(r.pieces[0].boundary_loops == 1);
}

TEST_CASE("a T-junction that gapes is closed only within the tolerance") {
  TriangleMesh m = shapes::t_junction_grid(4);
  for (Vec3f& p : m.positions) {
    if (p.x == 0 && p.y != std::floor(p.y)) p.x = 0.01F;
  }
  const Welded welded = weld(m.positions, m.triangles);
  CHECK(repaired(welded.mesh).pieces.size() == 2);
  CHECK(repaired(welded.mesh, 0.02).pieces.size() == 1);
}

TEST_CASE("random triangles over few points come out as spheres") {
  // The worst soups: edges of many triangles, double edges, sheets that touch, one-sided pieces, all at once.
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const std::size_t points = 4 + random() % 12, triangles = 1 + random() % 80;
    TriangleMesh m;
    std::normal_distribution<float> coordinate;
    for (std::size_t v = 0; v < points; ++v)
      m.positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
    std::set<std::array<Index, 3>> seen;
    for (std::size_t t = 0; t < triangles; ++t) {
      const auto pick = [&] { return static_cast<Index>(random() % points); };
      Triangle s{pick(), pick(), pick()};
      if (s[0] == s[1] || s[1] == s[2] || s[2] == s[0]) continue;
      std::rotate(s.begin(), std::ranges::min_element(s), s.end());
      if (seen.insert(s).second) m.triangles.push_back(s);
    }
    if (m.triangles.empty()) continue;
    CAPTURE(seed);
    static_cast<void>(repaired(m));
  }
}

TEST_CASE("random surfaces with handles, holes and flipped faces come out as spheres") {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::array<int, 3>> cubes;
    for (int x = 0; x < 4; ++x) {
      for (int y = 0; y < 4; ++y) {
        for (int z = 0; z < 4; ++z) {
          if (random() % 2 == 0) cubes.push_back({x, y, z});
        }
      }
    }
    TriangleMesh m = shapes::voxels(cubes);
    const unsigned defect = seed % 4;
    std::erase_if(m.triangles, [&](const Triangle&) { return defect == 1 && random() % 9 == 0; });
    for (Triangle& t : m.triangles) {
      if (defect == 2 && random() % 5 == 0) std::swap(t[0], t[1]);
    }
    CAPTURE(seed);
    static_cast<void>(repaired(m));
  }
}
