// A small software renderer: triangles with an atlas, a z-buffer, two lights.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/texture/raster.h"
#include "core/texture/sampler.h"
#include "core/vec3.h"

namespace orbis::texture {

// The vertices of a cut mesh as they are to be drawn.
struct Shape {
  const CutMesh& mesh;
  std::vector<Vec3d> positions, normals; // one per vertex
};

// Normals by the areas of the triangles around each point of the surface, the same at every copy of a point.
[[nodiscard]] std::vector<Vec3d> smooth_normals(const CutMesh& mesh, std::span<const Vec3d> positions);

// Part of a picture, in pixels.
struct Viewport {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

class Canvas {
public:
  Canvas(std::uint32_t width, std::uint32_t height);

  // Draws the shape so that it fills the viewport but for a margin. The shape keeps its own depth: viewports must not
  // overlap.
  void draw(const Shape& shape, const Image& atlas, const Viewport& viewport);
  // Averages the sub-pixels. RGB.
  [[nodiscard]] Image picture() const;

private:
  struct Fragment {
    std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
    float depth = -std::numeric_limits<float>::infinity(); // 1 / distance: larger is nearer
    float b = 0, c = 0;                                    // weights of the second and third corner in space
  };
  std::uint32_t width_, height_; // sub-pixels
  std::vector<Light> lights_;    // one per sub-pixel

  void paint_background();
};

} // namespace orbis::texture
