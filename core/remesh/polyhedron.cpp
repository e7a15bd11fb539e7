#include "core/remesh/polyhedron.h"

#include <array>

#include "core/mesh/edges.h"

namespace orbis::remesh {
namespace {

SphereMesh octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

// Three golden rectangles, each in a plane of two axes.
SphereMesh icosahedron() {
  constexpr double g = 1.6180339887498949; // the golden ratio
  SphereMesh out{{{-1, g, 0},
                  {1, g, 0},
                  {-1, -g, 0},
                  {1, -g, 0},
                  {0, -1, g},
                  {0, 1, g},
                  {0, -1, -g},
                  {0, 1, -g},
                  {g, 0, -1},
                  {g, 0, 1},
                  {-g, 0, -1},
                  {-g, 0, 1}},
                 {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (Vec3d& p : out.points) p = normalized(p);
  return out;
}

SphereMesh divided(const SphereMesh& mesh) {
  SphereMesh out;
  out.points = mesh.points;
  std::vector<mesh::Triangle> middles(mesh.triangles.size()); // [k]: of the edge from corner k to the next
  const mesh::EdgeTable edges(mesh.triangles, mesh.points.size());
  edges.for_each([&](mesh::Index low, mesh::Index high, std::span<const mesh::EdgeSide> sides) {
    const auto middle = static_cast<mesh::Index>(out.points.size());
    out.points.push_back(normalized(mesh.points[low] + mesh.points[high]));
    for (const mesh::EdgeSide& side : sides) middles[side.half_edge / 3][side.half_edge % 3] = middle;
  });
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto& [ab, bc, ca] = middles[t];
    for (const mesh::Triangle& part : {mesh::Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
      out.triangles.push_back(part);
  }
  return out;
}

} // namespace

std::uint64_t triangles_of(RemeshTarget::Base base, std::uint32_t times) {
  return std::uint64_t{base == RemeshTarget::Base::octahedral ? 8U : 20U} << (2 * times);
}

SphereMesh subdivided(RemeshTarget::Base base, std::uint32_t times) {
  SphereMesh mesh = base == RemeshTarget::Base::octahedral ? octahedron() : icosahedron();
  for (std::uint32_t i = 0; i < times; ++i) mesh = divided(mesh);
  return mesh;
}

} // namespace orbis::remesh
