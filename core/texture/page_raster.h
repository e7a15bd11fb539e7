// The delivered triangles in the texels of a page.
#pragma once

#include <array>
#include <cstdint>

#include "core/texture/atlas.h"
#include "core/texture/raster.h"

namespace orbis::texture {

// The corners of a delivered triangle in texels of its page.
[[nodiscard]] inline std::array<RasterPoint, 3> in_page(const CutMesh& mesh, std::size_t triangle) {
  const Page& page = mesh.pages[mesh.page_of(triangle)];
  std::array<RasterPoint, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2f& uv = mesh.vertices[mesh.triangles[triangle][k]].uv;
    corners[k] = {double{uv.x} * page.width, double{uv.y} * page.height};
  }
  return corners;
}

// How the barycentric weights change with a step (x, y) in the page. The corners span an area.
[[nodiscard]] inline std::array<double, 3> weight_step(const std::array<RasterPoint, 3>& p, double x, double y) {
  const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  std::array<double, 3> step{};
  for (std::size_t k = 0; k < 3; ++k) {
    const RasterPoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    step[k] = ((b.x - a.x) * y - (b.y - a.y) * x) / area;
  }
  return step;
}

} // namespace orbis::texture
