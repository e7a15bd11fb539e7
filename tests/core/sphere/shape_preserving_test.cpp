#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/mesh/unit_positions.h"
#include "core/sphere/embedding.h"
#include "core/sphere/orientation.h"
#include "core/sphere/shape_preserving_mesh.h"
#include "core/sphere/shape_preserving_placement.h"
#include "core/sphere/shape_preserving_star.h"
#include "support/paper_models.h"
#include "support/shapes.h"

namespace {

using namespace orbis;
using namespace orbis::sphere;
using mesh::Index;
using mesh::Triangle;
using mesh::TriangleMesh;

constexpr double paper_threshold = 0.995;

// The mesh with its positions replaced by f(position, number).
template <class F> TriangleMesh bent(TriangleMesh mesh, F f) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] = f(mesh.positions[i], i);
  return mesh;
}

Embedding embed(const TriangleMesh& mesh) {
  NoProgress progress;
  return embed_shape_preserving(mesh, paper_threshold, progress);
}

// Triangles that are not positively oriented after rounding to the grid of the delivered points: an exact test.
std::size_t folded_on_grid(const TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  std::vector<GridPoint> grid;
  for (const Vec3d& p : points) grid.push_back(to_grid(p));
  return static_cast<std::size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return orientation(grid[t[0]], grid[t[1]], grid[t[2]]) <= 0;
  }));
}

void check_unfolded(const TriangleMesh& mesh) {
  const Embedding e = embed(mesh);
  REQUIRE(e.points.size() == mesh.positions.size());
  CHECK(folded_on_grid(mesh, e.points) == 0);
  double worst = 0;
  for (const Vec3d& p : e.points) worst = std::max(worst, std::abs(norm(p) - 1));
  CHECK(worst < 1e-14);
}

// The triangles, each turned so that its smallest number comes first.
std::set<Triangle> turned(const std::vector<Triangle>& triangles) {
  std::set<Triangle> out;
  for (Triangle t : triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.insert(t);
  }
  return out;
}

std::set<Triangle> triangles_of(const HalfEdgeMesh& mesh) {
  std::vector<Triangle> out;
  for (const auto f : mesh.faces()) {
    if (mesh.status(f).deleted()) continue;
    Triangle t{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(f)) t[k++] = static_cast<Index>(v.idx());
    out.push_back(t);
  }
  return turned(out);
}

std::size_t live_vertices(const HalfEdgeMesh& mesh) {
  std::size_t n = 0;
  for (const auto v : mesh.vertices()) n += mesh.status(v).deleted() ? 0 : 1;
  return n;
}

Star crooked_star(const Vec3d& centre, double size) {
  const TangentBasis basis = tangent_basis(centre);
  Star star{centre, {}, {0.3, 0.1, 0.25, 0.15, 0.2}};
  const std::vector<std::array<double, 2>> polar{{1, 0.1}, {0.4, 1.5}, {1.3, 2.2}, {0.8, 3.9}, {1.1, 5.3}};
  for (const auto& [r, a] : polar)
    star.ring.push_back(normalized(centre + basis.e1 * (size * r * std::cos(a)) + basis.e2 * (size * r * std::sin(a))));
  return star;
}

} // namespace

TEST_CASE("the paper's models have the paper's triangle counts and its Minimum") {
  // Table 1: cube5 15.39, lollypop 15.5, cross 13.81; over all its models 11.11 to 15.67.
  const std::vector<std::pair<TriangleMesh, std::size_t>> models{
      {test::cube5(), 300}, {test::lollypop(), 134}, {test::cross(), 280}};
  for (const auto& [mesh, triangles] : models) {
    CAPTURE(triangles);
    CHECK(mesh.triangles.size() == triangles);
    CHECK(mesh.positions.size() == triangles / 2 + 2); // Euler characteristic 2
    const Embedding e = embed(mesh);
    CHECK(folded_on_grid(mesh, e.points) == 0);
    CHECK(e.converged);
    const double minimum = shape_preserving_energy(mesh, e.points);
    CHECK(minimum > 11.1);
    CHECK(minimum < 15.7);
  }
}

TEST_CASE("an even triangulation of the sphere has the Minimum 8 pi / sqrt 3, and the map finds it again") {
  const float a = 0.525731112F, b = 0.850650808F; // the icosahedron
  TriangleMesh mesh{{{-a, b, 0},
                     {a, b, 0},
                     {-a, -b, 0},
                     {a, -b, 0},
                     {0, -a, b},
                     {0, a, b},
                     {0, -a, -b},
                     {0, a, -b},
                     {b, 0, -a},
                     {b, 0, a},
                     {-b, 0, -a},
                     {-b, 0, a}},
                    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int level = 0; level < 3; ++level) {
    mesh = shapes::subdivided(mesh);
    for (Vec3f& p : mesh.positions) p = normalized(p);
  }
  const double even = 8 * std::numbers::pi / std::sqrt(3.0);
  const std::vector<Vec3d> itself(mesh.positions.begin(), mesh.positions.end());
  CHECK(shape_preserving_energy(mesh, itself) == doctest::Approx(even).epsilon(0.02));
  CHECK(shape_preserving_energy(mesh, embed(mesh).points) == doctest::Approx(even).epsilon(0.06));
}

TEST_CASE("no triangle is folded, whatever the shape") {
  const TriangleMesh ball = shapes::sphere(3);
  SUBCASE("sphere") { check_unfolded(ball); }
  SUBCASE("needle") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t) { return Vec3f(p.x, p.y, 1000 * p.z); }));
  }
  SUBCASE("coin") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t) { return Vec3f(p.x, p.y, 1e-3F * p.z); }));
  }
  SUBCASE("spikes") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t i) { return i % 17 == 0 ? p * 20.0F : p; }));
  }
  SUBCASE("bumps") {
    check_unfolded(
        bent(ball, [](Vec3f p, std::size_t) { return p * (1 + 0.5F * std::sin(9 * p.x) * std::sin(7 * p.y)); }));
  }
  SUBCASE("random connectivity") { check_unfolded(shapes::RandomTriangulation(1).make(1000, 20000)); }
  SUBCASE("stacked: very uneven valences") { check_unfolded(shapes::RandomTriangulation(7).make(1500, 0)); }
  SUBCASE("two vertices of valence 1000") { check_unfolded(shapes::bipyramid(1000, 1)); }
  SUBCASE("a long thin tube") {
    std::vector<test::Circle> circles;
    for (int i = 0; i < 300; ++i) circles.push_back({4, 1, static_cast<float>(i)});
    check_unfolded(test::lathe(-1, circles, 300));
  }
}

TEST_CASE("no triangle is folded where the geometry says nothing") {
  const TriangleMesh ball = shapes::sphere(3);
  SUBCASE("all vertices in one point") {
    check_unfolded(bent(ball, [](Vec3f, std::size_t) { return Vec3f(1, 2, 3); }));
  }
  SUBCASE("all on a line") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t) { return Vec3f(p.x, 0, 0); }));
  }
  SUBCASE("all in a plane") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t) { return Vec3f(p.x, p.y, 0); }));
  }
  SUBCASE("rounded to a coarse grid: zero edges, zero areas") {
    check_unfolded(bent(ball, [](Vec3f p, std::size_t) {
      return Vec3f(std::round(2 * p.x), std::round(2 * p.y), std::round(2 * p.z));
    }));
  }
}

TEST_CASE("the smallest closed meshes") {
  for (const Index vertices : {4U, 5U, 6U, 7U, 8U}) {
    CAPTURE(vertices);
    check_unfolded(shapes::RandomTriangulation(vertices).make(vertices, 0));
  }
  check_unfolded(shapes::bipyramid(3, 1));
  check_unfolded(test::cube_complex({{0, 0, 0}}, 1));
}

TEST_CASE("the unit of length does not matter, from the smallest to the largest floats") {
  const TriangleMesh mesh = shapes::sphere(2);
  const std::vector<Vec3d> points = embed(mesh).points;
  for (const float scale : {0x1p-90F, 0x1p126F}) { // powers of two: the mesh keeps its shape to the bit
    const auto scaled = bent(mesh, [&](Vec3f p, std::size_t) { return p * scale; });
    CHECK(embed(scaled).points == points);
  }
  for (const float scale : {1e-30F, 1e-44F, 3e38F})
    check_unfolded(bent(mesh, [&](Vec3f p, std::size_t) { return p * scale; }));
  // One vertex far away flattens all others to almost nothing.
  check_unfolded(bent(mesh, [](Vec3f p, std::size_t i) { return i == 5 ? Vec3f(3e38F, 0, 0) : p; }));
}

TEST_CASE("the same mesh gives the same points, to the bit") {
  const TriangleMesh mesh = test::cross();
  CHECK(embed(mesh).points == embed(mesh).points);
}

TEST_CASE("splits undo collapses") {
  for (const TriangleMesh& mesh : {test::cross(), test::lollypop(), shapes::sphere(3),
                                   shapes::RandomTriangulation(3).make(500, 0), shapes::bipyramid(50, 2)}) {
    NoProgress progress;
    HalfEdgeMesh surface = make_half_edge_mesh(mesh, mesh::unit_positions(mesh), progress);
    const std::vector<Collapse> collapses = collapse_to_tetrahedron(surface, progress);
    CHECK(live_vertices(surface) == 4);
    CHECK(triangles_of(surface).size() == 4);
    for (auto c = collapses.rbegin(); c != collapses.rend(); ++c) split_vertex(surface, *c);
    CHECK(live_vertices(surface) == mesh.positions.size());
    CHECK(triangles_of(surface) == turned(mesh.triangles));
  }
}

TEST_CASE("a ring runs counter-clockwise seen from outside") {
  const TriangleMesh mesh = shapes::sphere(1);
  NoProgress progress;
  const HalfEdgeMesh surface = make_half_edge_mesh(mesh, mesh::unit_positions(mesh), progress);
  const std::set<Triangle> triangles = turned(mesh.triangles);
  std::vector<Index> ring;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    one_ring(surface, v, ring);
    for (std::size_t k = 0; k < ring.size(); ++k)
      CHECK(triangles.contains(*turned({{v, ring[k], ring[(k + 1) % ring.size()]}}).begin()));
  }
}

TEST_CASE("squared angles agree with arc cosines, and keep their digits where arc cosines lose them") {
  for (const double angle : {3.0, 1.5, 0.5, 0.23, 0.22, 0.1}) {
    const double chord = 2 * std::sin(angle / 2);
    CHECK(squared_angle(chord * chord) == doctest::Approx(angle * angle).epsilon(1e-13));
  }
  CHECK(squared_angle(1e-20) == doctest::Approx(1e-20).epsilon(1e-14));
  CHECK(squared_angle(0) == 0);
}

TEST_CASE("gradient and Hessian of the energy agree with finite differences") {
  for (const double size : {1.0, 0.1, 1e-3}) {
    for (const double floor : {0.0, 3.0}) { // in units of the star's area; the barrier acts in the second case
      CAPTURE(size);
      CAPTURE(floor);
      const Star star = crooked_star(normalized(Vec3d(0.3, -0.5, 0.8)), size);
      const double barrier_floor = floor * size * size;
      const StarDerivatives d = star_derivatives(star, star.centre, barrier_floor);
      // Along the great circle in direction (a, b).
      const auto energy = [&](double a, double b) {
        const double length = std::hypot(a, b);
        if (length == 0) return star_energy(star, star.centre, barrier_floor);
        const Vec3d u = (d.e1 * a + d.e2 * b) * (1 / length);
        return star_energy(star, star.centre * std::cos(length) + u * std::sin(length), barrier_floor);
      };
      const double h = 1e-4 * size, value = energy(0, 0), scale = value / (size * size);
      CHECK(d.value == doctest::Approx(value));
      CHECK((energy(h, 0) - energy(-h, 0)) / (2 * h) == doctest::Approx(d.g1).epsilon(1e-4 * scale * size));
      CHECK((energy(0, h) - energy(0, -h)) / (2 * h) == doctest::Approx(d.g2).epsilon(1e-4 * scale * size));
      CHECK((energy(h, 0) - 2 * value + energy(-h, 0)) / (h * h) == doctest::Approx(d.h11).epsilon(1e-3));
      CHECK((energy(0, h) - 2 * value + energy(0, -h)) / (h * h) == doctest::Approx(d.h22).epsilon(1e-3));
      const double mixed = (energy(h, h) - energy(h, -h) - energy(-h, h) + energy(-h, -h)) / (4 * h * h);
      CHECK(mixed == doctest::Approx(d.h12).epsilon(1e-2 * d.h11 / std::abs(d.h12)));
    }
  }
}

TEST_CASE("without a floor the best place is the weighted Karcher mean") {
  const Star star = crooked_star(normalized(Vec3d(-0.2, 0.9, 0.1)), 0.2);
  const Place best = best_place(star, 0, 1e-12);
  CHECK(best.ratio < 1);
  // There the weighted logarithms cancel: the gradient is zero.
  const StarDerivatives d = star_derivatives(star, best.point, 0);
  CHECK(std::hypot(d.g1, d.g2) < 1e-6);
  CHECK(best.ratio == doctest::Approx(angle_energy(star, best.point) / angle_energy(star, star.centre)));
}

TEST_CASE("a star that reaches beyond the hemisphere is improved too, and not folded") {
  Star star{normalized(Vec3d(0.5, 0, 1)), {}, {0.25, 0.25, 0.25, 0.25}};
  const double low = -0.2; // height of the ring: below the equator
  for (int k = 0; k < 4; ++k) {
    const double angle = std::numbers::pi / 2 * k, r = std::sqrt(1 - low * low);
    star.ring.emplace_back(r * std::cos(angle), r * std::sin(angle), low);
  }
  const Place best = best_place(star, 0.01, 1e-4);
  CHECK(best.ratio <= 1);
  CHECK(std::isfinite(star_energy(star, best.point, 0.01)));
}

TEST_CASE("an inserted vertex sees its whole ring, in wide and in narrow wedges") {
  const Vec3d parent = normalized(Vec3d(0.1, 0.2, 1));
  const TangentBasis basis = tangent_basis(parent);
  const auto at = [&](double r, double a) {
    return normalized(parent + basis.e1 * (r * std::cos(a)) + basis.e2 * (r * std::sin(a)));
  };
  for (const double opening : {1e-3, 0.5, 3.0, 4.0, 6.2}) {
    for (const double size : {0.3, 1e-3, 1e-6}) {
      CAPTURE(opening);
      CAPTURE(size);
      // left, two between, right: counter-clockwise about the parent, and about the new vertex too.
      const Star star{
          parent,
          {parent, at(size, 0), at(0.3 * size, opening / 3), at(size, opening / 1.5), at(0.5 * size, opening)},
          {0.2, 0.2, 0.2, 0.2, 0.2}};
      const Vec3d point = insertion_place(star, 0, 1, 4, 1e-3 * size * size);
      CHECK(std::isfinite(star_energy(star, point, 1e-3 * size * size)));
      CHECK(norm(point - parent) < size);
    }
  }
}

TEST_CASE("a Moebius map keeps the sphere, and moves the given point to the centre") {
  const Vec3d a(0.3, -0.2, 0.4);
  CHECK(norm(moebius(normalized(a), a) - normalized(a)) < 1e-12); // poles stay
  CHECK(norm(moebius(-normalized(a), a) + normalized(a)) < 1e-12);
  CHECK(std::abs(norm(moebius(normalized(Vec3d(1, 2, 3)), a)) - 1) < 1e-15);
  CHECK(norm(moebius(moebius(Vec3d(0, 1, 0), a), -a) - Vec3d(0, 1, 0)) < 1e-12); // the inverse
}

TEST_CASE("what is said to survive rounding does, also where the margin is thin") {
  std::mt19937 random(5);
  const auto coordinate = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  int said = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = normalized(Vec3d(coordinate(), coordinate(), 1.5));
    const TangentBasis basis = tangent_basis(p);
    // A thin triangle, of some multiples of 2^-24 in height, along e1.
    const double length = std::exp2(-10 * std::abs(coordinate())), height = 0x1p-24 * 8 * coordinate();
    const std::vector<Vec3d> points{p, normalized(p + basis.e1 * length),
                                    normalized(p + basis.e1 * (0.4 * length) + basis.e2 * height)};
    const TriangleMesh one{{}, {{0, 1, 2}}};
    if (!survives_rounding(one.triangles, points)) continue;
    ++said;
    CHECK(folded_on_grid(one, points) == 0);
  }
  CHECK(said > 100);
  CHECK(said < 1000);
}

TEST_CASE("every map that is delivered survives rounding, with a proof") {
  for (const TriangleMesh& mesh : {test::cross(), shapes::RandomTriangulation(2).make(800, 0), shapes::bipyramid(300),
                                   shapes::tube(200, 3, 600)}) {
    CHECK(survives_rounding(mesh.triangles, embed(mesh).points));
  }
}

TEST_CASE("progress rises to its total in each stage, and the stages follow each other") {
  struct Recorder final : Progress {
    std::vector<std::array<std::uint64_t, 3>> seen;
    void report(Stage stage, std::uint64_t done, std::uint64_t total) override {
      seen.push_back({static_cast<std::uint64_t>(stage), done, total});
    }
    [[nodiscard]] bool cancelled() const override { return false; }
  } progress;
  static_cast<void>(embed_shape_preserving(shapes::sphere(4), paper_threshold, progress));
  REQUIRE(progress.seen.size() > 5);
  CHECK(std::is_sorted(progress.seen.begin(), progress.seen.end()));
  std::map<std::uint64_t, std::array<std::uint64_t, 3>> last;
  for (const auto& report : progress.seen) last[report[0]] = report;
  CHECK(last.size() == 3);
  for (const auto& [stage, report] : last) CHECK(report[1] == report[2]);
}

TEST_CASE("a cancelled job stops at the next look, in any stage") {
  struct Canceller final : Progress {
    explicit Canceller(int after) : left(after) {}
    mutable int left;
    void report(Stage, std::uint64_t, std::uint64_t) override {}
    [[nodiscard]] bool cancelled() const override { return left-- <= 0; }
  };
  const TriangleMesh mesh = shapes::sphere(4);
  Canceller never(1 << 30);
  static_cast<void>(embed_shape_preserving(mesh, paper_threshold, never));
  const int looks = (1 << 30) - never.left;
  REQUIRE(looks > 20);
  for (const int after : {0, 1, looks / 4, looks / 2, looks - 1}) {
    Canceller progress(after);
    try {
      static_cast<void>(embed_shape_preserving(mesh, paper_threshold, progress));
      FAIL("not cancelled");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::canceled);
    }
    CHECK(progress.left == -1); // thrown at the first look that said so
  }
}
