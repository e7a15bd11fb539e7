// The full surface's normals in the atlas, as 8-bit images: what makes a coarse level look like the full surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/lod/full_surface.h"
#include "core/lod/render.h"

namespace orbis::lod {

// Object-space normals. Unlike those in tangent space they serve every level alike, whatever its own normals are; so
// they measure what a level's geometry and map can do.
class NormalMap {
public:
  // normals: one per vertex of full.cut(), unit length. The texels next to the charts take the nearest chart's normals.
  NormalMap(const FullSurface& full, std::span<const Vec3d> normals);

  // The bilinear read at a place in the atlas; not normalized.
  [[nodiscard]] Vec3d at(const Uv& uv, std::uint32_t page) const;
  // The normals of a level that is lit through the map. Keeps references to both.
  [[nodiscard]] NormalsAt on(const texture::CutMesh& level) const;

private:
  using Texel = std::array<std::int8_t, 3>;
  struct Page {
    std::uint32_t width = 0, height = 0;
    std::vector<Texel> texels;
  };
  static void spread(Page& page);

  std::vector<Page> pages_;
};

} // namespace orbis::lod
