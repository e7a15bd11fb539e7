// Which point of the surface does each texel of a page show? Answered once, for all the maps that are baked into it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/texture/raster.h"
#include "core/vec3.h"

namespace orbis::texture {

// The triangles that a page shows, as they lie in it.
struct PageMesh {
  std::span<const Vec2f> uv;                 // one per vertex, [0, 1], v down
  std::span<const mesh::Triangle> triangles; // indices into uv
  std::span<const std::uint32_t> shown;      // which triangles lie on this page, ascending
};

// A triangle on its page, and the barycentric weights as functions of the place in the page.
struct TriangleInPage {
  std::array<RasterPoint, 3> corners;  // in texels
  std::array<double, 3> along_x{};     // how the weights change from a texel to the one on its right,
  std::array<double, 3> along_y{};     // and to the one below
  std::array<double, 3> at_corner_0{}; // (1, 0, 0): the weights at corners[0]

  // The weights at a place (x, y), in texels, inside or not.
  [[nodiscard]] std::array<double, 3> weights(double x, double y) const {
    const double dx = x - corners[0].x, dy = y - corners[0].y;
    std::array<double, 3> w{};
    for (std::size_t k = 0; k < 3; ++k) w[k] = at_corner_0[k] + along_x[k] * dx + along_y[k] * dy;
    return w;
  }
  // The weights at the point of the triangle that is nearest to (x, y) in the page.
  [[nodiscard]] std::array<double, 3> nearest_weights(double x, double y) const;
};

// One number a texel: the triangle that it shows. The weights are computed anew where they are asked for, which is
// exact and takes a few operations, instead of being stored.
//
// Texels that no triangle covers, the gutters and what is left of the page, belong to the triangle that shows up next
// to them, at its nearest point: every map then fills its gutters by itself, in its own terms (a tangent-space normal
// in the frame of the chart that it borders), so that bilinear and mip-mapped reads near a chart's border
// find the chart's own values.
class TexelMap {
public:
  static constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

  // width, height: up to 2^14. Where triangles overlap (by less than the raster's 2^-16 of a texel), the later one is
  // shown. O(texels + triangles), the same on any number of threads.
  TexelMap(const PageMesh& mesh, std::uint32_t width, std::uint32_t height, mesh::ThreadPool& pool);

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  // `nothing` only on a page without triangles.
  [[nodiscard]] std::uint32_t triangle(std::uint32_t x, std::uint32_t y) const {
    return triangle_[std::size_t{y} * width_ + x];
  }
  // Whether the texel's centre lies in its triangle; else it is part of a gutter.
  [[nodiscard]] bool covered(std::uint32_t x, std::uint32_t y) const {
    return covered_[std::size_t{y} * width_ + x] != 0;
  }
  [[nodiscard]] std::uint64_t covered_texels() const { return covered_texels_; }
  [[nodiscard]] TriangleInPage place(std::uint32_t triangle) const;
  [[nodiscard]] std::span<const std::uint32_t> shown() const { return mesh_.shown; }

  // Walks over the texels of rows [begin, end), some rows at a time, triangle by triangle: shader.triangle(t, place),
  // then shader.texel(x, y, weights) for its texels there.
  template <class Shader> void walk(std::size_t begin, std::size_t end, Shader& shader) const {
    std::vector<Run> runs;
    for (std::size_t top = begin; top < end; top += Run::rows) {
      find_runs(top, std::min(top + Run::rows, end), runs);
      std::uint32_t shown = nothing;
      TriangleInPage place_of_shown;
      for (const Run& run : runs) {
        if (run.triangle() != shown) {
          shown = run.triangle();
          place_of_shown = place(shown);
          shader.triangle(shown, place_of_shown);
        }
        const auto y = static_cast<std::uint32_t>(top) + run.row();
        for (std::uint32_t x = run.first(); x <= run.last(); ++x) {
          const double px = x + 0.5, py = y + 0.5;
          shader.texel(x, y, covered(x, y) ? place_of_shown.weights(px, py) : place_of_shown.nearest_weights(px, py));
        }
      }
    }
  }

private:
  // Texels beside each other in a row that show the same triangle, in the bits of one number: sorted, they come
  // triangle by triangle.
  struct Run {
    static constexpr std::size_t rows = 16;
    std::uint64_t bits;

    Run(std::uint32_t triangle, std::uint32_t row, std::uint32_t first, std::uint32_t last)
        : bits(std::uint64_t{triangle} << 32U | std::uint64_t{row} << 28U | std::uint64_t{first} << 14U | last) {}
    [[nodiscard]] std::uint32_t triangle() const { return static_cast<std::uint32_t>(bits >> 32U); }
    [[nodiscard]] std::uint32_t row() const { return static_cast<std::uint32_t>(bits >> 28U) & 15U; }
    [[nodiscard]] std::uint32_t first() const { return static_cast<std::uint32_t>(bits >> 14U) & 0x3fffU; }
    [[nodiscard]] std::uint32_t last() const { return static_cast<std::uint32_t>(bits) & 0x3fffU; }
  };
  // Of rows [top, end), sorted.
  void find_runs(std::size_t top, std::size_t end, std::vector<Run>& runs) const;

  [[nodiscard]] std::array<RasterPoint, 3> corners(std::uint32_t triangle) const;
  void cover(mesh::ThreadPool& pool);
  void spread();

  PageMesh mesh_;
  std::uint32_t width_, height_;
  std::vector<std::uint32_t> triangle_;
  std::vector<std::uint8_t> covered_;
  std::uint64_t covered_texels_ = 0;
};

} // namespace orbis::texture
