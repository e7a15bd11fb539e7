// Pictures of a level beside those of the full surface, and how much they differ.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/lod/full_surface.h"
#include "core/lod/normal_map.h"
#include "core/lod/simplify.h"
#include "core/mesh/thread_pool.h"

namespace orbis::lod {

// Brightness from 0 to 1, rows from the top; `background` where there is no surface.
inline constexpr float background = -1;
struct Picture {
  std::uint32_t size = 0; // pixels along each side
  std::vector<float> light;
};

// How a level gets its normals.
enum class Shading { normal_map, own_normals };

class Photographer {
public:
  static constexpr std::size_t views = 6;

  // normals: one per vertex of full.cut(), unit length: those that the full surface is shaded with. size: of a picture
  // in pixels. All of it outlives the photographer.
  Photographer(const FullSurface& full, std::span<const Vec3d> normals, std::uint32_t size, mesh::ThreadPool& threads);

  // From six sides, along the axes of a cube that stands askew; without perspective, lit from over the shoulder. A
  // pixel is the mean of four subpixels; it shows the surface if all of them do.
  [[nodiscard]] Picture of_full(std::size_t view) const;
  [[nodiscard]] Picture of(const Level& level, Shading shading, std::size_t view) const;

  // Peak signal to noise ratio of all views together, in dB, over the pixels that show both surfaces. Infinite where
  // the pictures are the same.
  [[nodiscard]] double psnr(const Level& level, Shading shading) const;

private:
  const FullSurface& full_;
  std::span<const Vec3d> normals_;
  std::uint32_t size_;
  mesh::ThreadPool& threads_;
  NormalMap map_;
  std::vector<Picture> pictures_; // of the full surface
};

} // namespace orbis::lod
