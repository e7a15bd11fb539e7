// How far two surfaces are from each other, and how far a texture slides between them.
#pragma once

#include <memory>
#include <span>

#include "core/lod/full_surface.h"
#include "core/lod/simplify.h"
#include "core/lod/triangle_tree.h"
#include "core/mesh/thread_pool.h"

namespace orbis::lod {

// Of points spread evenly over the surfaces. A Ruler's are fractions of the bounding box's diagonal.
struct Distances {
  double to_full = 0;   // mean distance of the level's points from the full surface
  double from_full = 0; // and of the full surface's from the level
  double hausdorff = 0; // the largest in either direction, the full surface's vertices among the points
};

// Of a surface from another one, which is called full: 20,000 points spread by area over each, and all vertices of the
// full one. Positions in the same units; each surface has at least one triangle.
[[nodiscard]] Distances distances_between(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                                          std::span<const Vec3d> full_positions,
                                          std::span<const mesh::Triangle> full_triangles, mesh::ThreadPool& threads);

// The difference between a level's point and the full surface's point of the same texel, over the level's surface.
struct TextureDeviation {
  double mean = 0, largest = 0; // as fractions of the diagonal
  double outside = 0;           // part of the level's surface whose texels lie outside of the charts
};

// Measures levels against the full surface. Deterministic: the samples depend on the surfaces alone, the sums not on
// the number of threads.
class Ruler {
public:
  // Both outlive the ruler.
  Ruler(const FullSurface& full, mesh::ThreadPool& threads);

  [[nodiscard]] Distances distances(const Level& level) const;
  [[nodiscard]] TextureDeviation texture_deviation(const Level& level) const;

private:
  [[nodiscard]] std::optional<Place> find(const Level& level, std::uint32_t triangle, const Uv& uv) const;
  [[nodiscard]] std::optional<Place> search(std::uint32_t chart, const Uv& uv) const;

  const FullSurface& full_;
  mesh::ThreadPool& threads_;
  TriangleTree tree_;
  std::vector<std::vector<std::uint32_t>> of_chart_; // chart -> triangles
};

} // namespace orbis::lod
