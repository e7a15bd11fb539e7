// How far a map is from an isometry: the measures of docs/parametrization.md.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::sphere {

// s1 >= s2: singular values of a triangle's linear map from the surface to the (chordal) triangle on the sphere, after
// scaling so that both total areas are equal. Means are weighted by surface area. Needles do not count: triangles less
// than a ten-millionth as high as long, whose shape float positions cannot hold.
struct Distortion {
  double quasi_conformal_mean = 1; // s1 / s2; 1 = conformal
  double quasi_conformal_p99 = 1;
  double log_area_deviation = 0;  // standard deviation of log(s1 s2); 0 = equiareal
  double symmetric_dirichlet = 1; // mean of (s1^2 + s2^2 + 1/s1^2 + 1/s2^2) / 4; 1 = isometric
  double l2_stretch = 1;          // sqrt(mean of (1/s1^2 + 1/s2^2) / 2), Sander et al. 2001; 1 = isometric
  double smallest_area = 0;       // of a sphere triangle, in steradians
  std::uint64_t needles = 0;      // triangles that did not count
};

[[nodiscard]] Distortion measure_distortion(const mesh::TriangleMesh& mesh, std::span<const Vec3f> points);

} // namespace orbis::sphere
