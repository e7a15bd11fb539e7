// A small software renderer: triangles with the pages of an atlas, a z-buffer, two lights.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/texture/sampler.h"
#include "core/vec3.h"

namespace orbis::texture {

// A cut mesh as it is to be drawn.
struct Shape {
  const CutMesh& mesh;
  std::vector<Vec3d> positions, normals;   // one per vertex
  std::vector<std::array<float, 3>> tints; // one per triangle: what its texels are multiplied by; empty: 1
};

// Normals by the areas of the triangles around each point of the surface, the same at every copy of a point.
[[nodiscard]] std::vector<Vec3d> smooth_normals(const CutMesh& mesh, std::span<const Vec3d> positions);

// Part of a picture, in pixels.
struct Viewport {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

class Canvas {
public:
  // Keeps references to the pages, the atlas' images, and to the pool. The same picture on any number of threads.
  Canvas(std::uint32_t width, std::uint32_t height, std::span<const Image> pages, mesh::ThreadPool& pool);

  // Draws the shape so that it fills the viewport but for a margin. The shape keeps its own depth: viewports must not
  // overlap. Edges are smoothed by 2 x 2 sub-pixels; each triangle is shaded once a pixel.
  void draw(const Shape& shape, const Viewport& viewport);
  // RGB.
  [[nodiscard]] Image picture() const;

private:
  std::uint32_t width_, height_;
  mesh::ThreadPool& pool_;
  std::vector<Sampler> samplers_; // one per page
  std::vector<Light> lights_;     // one per pixel

  void paint_background();
};

// Width / height of a shape as draw() shows it.
[[nodiscard]] double aspect_of(const Shape& shape);

} // namespace orbis::texture
