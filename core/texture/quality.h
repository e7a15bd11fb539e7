// How good an atlas is: what it costs in seams, and how evenly it spreads texels.
#pragma once

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

// surface: what the atlas was made for. Triangles without area do not count.
[[nodiscard]] AtlasQuality measure_atlas(const CutMesh& mesh, const mesh::TriangleMesh& surface);

} // namespace orbis::texture
