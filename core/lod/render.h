// Pictures of a level beside those of the full surface, and how much they differ.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::lod {

// Brightness from 0 to 1, rows from the top; `background` where there is no surface.
inline constexpr float background = -1;
struct Picture {
  std::uint32_t size = 0; // pixels along each side
  std::vector<float> light;
};

// A point of a triangle, by the weights of its second and third corner.
struct Spot {
  std::uint32_t triangle = 0;
  float b = 0, c = 0;
};

// The normals that a renderer lights spots with, at any length; called from several threads at once.
using NormalsAt = std::function<void(std::span<const Spot>, std::span<Vec3f>)>;

// What is drawn.
struct Sitter {
  std::span<const Vec3f> positions;
  std::span<const mesh::Triangle> triangles;
  NormalsAt normals_at;
};

// Normals that are given at the vertices, interpolated. Keeps references to both.
[[nodiscard]] NormalsAt interpolated(std::span<const Vec3d> normals, std::span<const mesh::Triangle> triangles);

class Photographer {
public:
  static constexpr std::size_t views = 6;

  // full: what the pictures are compared with, and what the frame is set for. size: of a picture in pixels. What is
  // shown outlives the photographer.
  Photographer(Sitter full, std::uint32_t size, mesh::ThreadPool& threads);

  // From six sides, along the axes of a cube that stands askew; without perspective, lit from over the shoulder. A
  // pixel is the mean of four subpixels; it shows the surface if all of them do.
  [[nodiscard]] Picture of_full(std::size_t view) const { return pictures_[view]; }
  [[nodiscard]] Picture of(const Sitter& sitter, std::size_t view) const;

  // Peak signal to noise ratio of all views together, in dB, over the pixels that show both surfaces. Infinite where
  // the pictures are the same.
  [[nodiscard]] double psnr(const Sitter& level) const;

private:
  std::uint32_t size_;
  mesh::ThreadPool& threads_;
  Vec3d centre_;                  // of the full surface's bounding box,
  double scale_;                  // and 1 / its diagonal
  std::vector<Picture> pictures_; // of the full surface
};

} // namespace orbis::lod
