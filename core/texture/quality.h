// How good an atlas is: what it costs in seams, and how evenly it spreads texels.
#pragma once

#include <array>

#include "core/mesh/triangle_mesh.h"
#include "core/texture/atlas.h"

namespace orbis::texture {

struct AtlasQuality {
  // Texels per unit of area, in units of their mean over the surface: of the delivered triangle that has fewest, at the
  // first percentile and at the median of the surface (by area). 1 everywhere is an even atlas.
  double density_min = 1, density_p1 = 1, density_median = 1;
  double texels_per_area = 0; // the mean itself: texels that show the surface / its area, in the units of the input
  // sqrt(mean of (1/s1^2 + 1/s2^2) / 2), s1, s2 the stretches from the surface to the atlas scaled to equal areas
  // (Sander et al. 2001); 1 = isometric.
  double l2_stretch = 1;
  // Cuts, each counted once, over the square root of the area, both summed over the components; edges at which the
  // input itself is open do not count.
  double seam_length = 0;
};

// (1/s1^2 + 1/s2^2) / 2 of the linear map from triangle p to its image q, which is |map back|^2 / 2.
//   q        points in the plane, with x and y
//   q_area   its area, above 0
template <class Point>
[[nodiscard]] double squared_stretch(const std::array<Vec3d, 3>& p, const std::array<Point, 3>& q, double q_area) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const double cosine = (q[i].x - q[k].x) * (q[j].x - q[k].x) + (q[i].y - q[k].y) * (q[j].y - q[k].y);
    sum += cosine * squared_norm(p[i] - p[j]);
  }
  return sum / (8 * q_area * q_area);
}

// surface: what the atlas was made for. Triangles without area do not count.
[[nodiscard]] AtlasQuality measure_atlas(const CutMesh& mesh, const mesh::TriangleMesh& surface);

} // namespace orbis::texture
