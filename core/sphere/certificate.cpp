// Closed, connected, manifold, Euler characteristic 2: the surface is a sphere. Every triangle positively oriented: the
// map is a local homeomorphism away from the vertices, and a covering with branch points at the vertices. Degree 1: it
// covers once, so nothing branches. Together: the radial projection is a homeomorphism.
#include "core/sphere/certificate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/edges.h"
#include "core/sphere/orientation.h"
#include "core/sphere/sphere_math.h"

namespace orbis::sphere {
namespace {

// Two half-edges on every edge, in opposite directions; the corners around each vertex in one fan; one component.
void check_surface(std::span<const mesh::Triangle> triangles, std::size_t vertex_count, Certificate& out) {
  const mesh::EdgeTable edges(triangles, vertex_count);
  mesh::DisjointSets corners(triangles.size() * 3), components(vertex_count);
  std::uint64_t edge_count = 0;
  out.closed = !triangles.empty();
  edges.for_each([&](mesh::Index low, mesh::Index high, std::span<const mesh::EdgeSide> sides) {
    ++edge_count;
    components.unite(low, high);
    const auto next = [](std::uint32_t h) { return h - h % 3 + (h % 3 + 1) % 3; };
    const auto start = [&](std::uint32_t h) { return triangles[h / 3][h % 3]; };
    if (sides.size() != 2 || start(sides[0].half_edge) == start(sides[1].half_edge)) {
      out.closed = false;
      return;
    }
    // Opposite directions: one starts where the other ends.
    corners.unite(sides[0].half_edge, next(sides[1].half_edge));
    corners.unite(next(sides[0].half_edge), sides[1].half_edge);
  });
  out.manifold = out.closed && corners.count() == vertex_count;
  out.connected = components.count() == 1;
  out.euler_characteristic = static_cast<std::int64_t>(vertex_count) - static_cast<std::int64_t>(edge_count) +
                             static_cast<std::int64_t>(triangles.size());
}

std::vector<GridPoint> read_points(std::span<const Vec3f> points, Certificate& out) {
  std::vector<GridPoint> grid(points.size(), GridPoint{});
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!grid_point_of(points[v], grid[v])) ++out.off_grid;
    out.max_radius_error = std::max(out.max_radius_error, std::abs(norm(Vec3d(points[v])) - 1));
  }
  return grid;
}

Certificate counted(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles) {
  Certificate out;
  out.vertices = points.size();
  out.triangles = triangles.size();
  return out;
}

bool in_range(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles) {
  return std::ranges::all_of(triangles, [&](const mesh::Triangle& t) {
    return std::ranges::all_of(t, [&](mesh::Index v) { return v < points.size(); });
  });
}

// One triangle on every edge, or two in opposite directions.
bool edges_agree(std::span<const mesh::Triangle> triangles, std::size_t vertex_count) {
  bool agree = !triangles.empty();
  const auto start = [&](std::uint32_t h) { return triangles[h / 3][h % 3]; };
  mesh::EdgeTable(triangles, vertex_count)
      .for_each([&](mesh::Index, mesh::Index, std::span<const mesh::EdgeSide> sides) {
        agree =
            agree && sides.size() < 3 && (sides.size() < 2 || start(sides[0].half_edge) != start(sides[1].half_edge));
      });
  return agree;
}

// Exact orientation of every triangle, and how often they cover the sphere, together with `other_angle`.
void check_map(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles, double other_angle,
               Certificate& out) {
  const std::vector<GridPoint> grid = read_points(points, out);
  for (const mesh::Triangle& t : triangles) {
    if (orientation(grid[t[0]], grid[t[1]], grid[t[2]]) != 1) ++out.folded;
  }
  out.degree = (solid_angle_of(points, triangles) + other_angle) / (4 * std::numbers::pi);
  out.valid = out.failure().empty();
}

} // namespace

double solid_angle_of(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles) {
  double sum = 0;
  for (const mesh::Triangle& t : triangles)
    sum += solid_angle(Vec3d(points[t[0]]), Vec3d(points[t[1]]), Vec3d(points[t[2]]));
  return sum;
}

Certificate certify(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles) {
  Certificate out = counted(points, triangles);
  if (!in_range(points, triangles)) return out;
  check_surface(triangles, points.size(), out);
  check_map(points, triangles, 0, out);
  return out;
}

Certificate certify_pieces(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles,
                           double caps_solid_angle) {
  Certificate out = counted(points, triangles);
  if (!in_range(points, triangles)) return out;
  out.closed = out.manifold = out.connected = edges_agree(triangles, points.size());
  out.euler_characteristic = 2;
  check_map(points, triangles, caps_solid_angle, out);
  return out;
}

std::string Certificate::failure() const {
  if (!closed) return "an edge does not have two triangles in opposite directions";
  if (!manifold) return "the triangles around a vertex form more than one fan";
  if (!connected) return "the surface has more than one component";
  if (euler_characteristic != 2) return "the Euler characteristic is " + std::to_string(euler_characteristic);
  if (off_grid > 0) return std::to_string(off_grid) + " sphere coordinates are not multiples of 2^-24";
  if (!(max_radius_error < 1e-6)) return "a sphere point is not of unit length";
  if (folded > 0) return std::to_string(folded) + " triangles are folded over";
  // Rounding leaves a few 1e-16 a triangle; the degree is an integer, so a tenth is far from both sides.
  if (!(std::abs(degree - 1) < 0.1)) return "the sphere is covered " + std::to_string(degree) + " times";
  return {};
}

} // namespace orbis::sphere
