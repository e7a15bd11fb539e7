// The proof that a result is a homeomorphism between the surface and the sphere (docs/parametrization.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::sphere {

struct Certificate {
  bool closed = false;   // every edge has exactly two triangles, in opposite directions
  bool manifold = false; // the triangles around each vertex form one fan
  bool connected = false;
  std::int64_t euler_characteristic = 0;
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t folded = 0;    // triangles whose exact orientation is not +1
  std::uint64_t off_grid = 0;  // vertices with a coordinate that is not a multiple of 2^-24
  double max_radius_error = 0; // max | |p| - 1 |
  double degree = 0;           // sum of signed solid angles / 4 pi, before rounding
  bool valid = false;          // all of it holds

  // One sentence for a person that names the first thing that fails; empty where valid.
  [[nodiscard]] std::string failure() const;
};

// points: one per vertex, as delivered (float32). triangles: the surface that was parametrized, indices into points.
[[nodiscard]] Certificate certify(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles);

// The same for the pieces of a surface that was closed by caps, without the caps: where a cap was, edges have one
// triangle. Required are two triangles in opposite directions on every other edge, and one covering of the sphere by
// pieces and caps together; `closed`, `manifold` and `connected` say so, and the Euler characteristic is that of the
// surface with its caps, which certify() has proven on the uncut triangles.
//   caps_solid_angle  of the caps' triangles, in steradians
[[nodiscard]] Certificate certify_pieces(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles,
                                         double caps_solid_angle);

// Sum of the signed solid angles, in steradians.
[[nodiscard]] double solid_angle_of(std::span<const Vec3f> points, std::span<const mesh::Triangle> triangles);

} // namespace orbis::sphere
