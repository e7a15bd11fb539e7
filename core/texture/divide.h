// One triangle of the surface divided into pieces, each in one face of the cube.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sphere/orientation.h"
#include "core/texture/border_crossings.h"
#include "core/texture/cube_map.h"

namespace orbis::texture {

// Where on its triangle a point lies.
enum class Site : std::uint8_t { corner_0, corner_1, corner_2, edge_01, edge_12, edge_20, inside };

struct DividedPoint {
  std::uint32_t point = 0; // identity on the surface; for points inside assigned by the caller
  sphere::GridPoint sphere{};
  FaceMask faces = 0;
  std::array<double, 3> barycentric{};
  Site site = Site::inside;
};

struct Piece {
  std::array<std::uint32_t, 3> points{}; // indices into Division::points
  Face face = 0;
};

struct Division {
  std::vector<DividedPoint>
      points; // the triangle's boundary, counter-clockwise from corner 0; then cube corners inside
  std::vector<Piece> pieces;
};

// boundary: the three corners and the border crossings on the edges, counter-clockwise from corner 0; neighbours on it
// share a face. The pieces' edges pair up inside the triangle and leave exactly its boundary, else
// Error{not_certified}; their orientation is not checked here.
[[nodiscard]] Division divide(std::vector<DividedPoint> boundary);

} // namespace orbis::texture
