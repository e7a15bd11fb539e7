// A small software renderer: triangles with the pages of an atlas, a z-buffer, two lights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/texture/image.h"
#include "core/texture/projection.h"
#include "core/texture/sampler.h"
#include "core/texture/shape.h"

namespace orbis::texture {

class Canvas {
public:
  // Keeps references to the pages, the atlas' images, and to the pool. The same picture on any number of threads.
  Canvas(std::uint32_t width, std::uint32_t height, std::span<const Image> pages, mesh::ThreadPool& pool);

  // Draws the shape so that it fills the viewport but for a margin. The shape keeps its own depth: viewports must not
  // overlap. Edges are smoothed by 2 x 2 sub-pixels; each triangle is shaded once a pixel. Alpha is taken as the
  // materials say, in any order of the triangles: a mask leaves out what is below its cutoff, and what is blended lies
  // over what is behind it, the nearest eight layers of it at each sub-pixel.
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

} // namespace orbis::texture
