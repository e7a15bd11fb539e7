// Atlases of sphere meshes for tests: the surface is the sphere itself.
#pragma once

#include "core/texture/atlas.h"
#include "core/texture/page_raster.h"
#include "sphere_meshes.h"

namespace sphere_meshes {

inline orbis::texture::CutMesh atlas_of(const SphereMesh& mesh, const std::vector<Triangle>& corners,
                                        std::uint32_t texture_size) {
  const std::vector<GridPoint> grid = mesh.grid();
  std::vector<orbis::Vec3f> positions;
  for (const Vec3d& p : mesh.points) positions.emplace_back(p);
  orbis::NoProgress progress;
  return orbis::texture::make_atlas({mesh.triangles, corners, grid, positions, mesh.triangles.size()}, texture_size,
                                    progress);
}
inline orbis::texture::CutMesh atlas_of(const SphereMesh& mesh, std::uint32_t texture_size) {
  return atlas_of(mesh, mesh.triangles, texture_size);
}

// The direction on the sphere that each covered texel of page 0 shows; zero where none does.
inline std::vector<Vec3d> directions(const orbis::texture::CutMesh& mesh) {
  const orbis::texture::Page& page = mesh.pages[0];
  std::vector<Vec3d> out(std::size_t{page.width} * page.height);
  orbis::texture::rasterize_page(
      mesh, 0, [&](std::uint32_t x, std::uint32_t y, std::uint32_t t, const std::array<double, 3>& weights) {
        Vec3d& d = out[std::size_t{y} * page.width + x];
        for (std::size_t k = 0; k < 3; ++k)
          d += Vec3d(orbis::sphere::from_grid(mesh.vertices[mesh.triangles[t][k]].sphere)) * weights[k];
      });
  return out;
}

} // namespace sphere_meshes
