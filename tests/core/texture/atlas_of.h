// Atlases of sphere meshes for tests: the surface is the sphere itself.
#pragma once

#include "core/texture/atlas.h"
#include "core/texture/bake.h"
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

// The triangles of a page as a texel map takes them.
struct AtlasPage {
  std::vector<orbis::Vec2f> uv;
  std::vector<std::uint32_t> shown;
  orbis::mesh::ThreadPool pool;
  orbis::texture::TexelMap map;

  AtlasPage(const orbis::texture::CutMesh& mesh, std::uint32_t page, std::uint32_t threads = 1)
      : uv(uv_of(mesh)), shown(shown_on(mesh, page)), pool(threads),
        map({uv, mesh.triangles, shown}, mesh.pages[page].width, mesh.pages[page].height, pool) {}

private:
  static std::vector<orbis::Vec2f> uv_of(const orbis::texture::CutMesh& mesh) {
    std::vector<orbis::Vec2f> out;
    for (const auto& v : mesh.vertices) out.push_back(v.uv);
    return out;
  }
  static std::vector<std::uint32_t> shown_on(const orbis::texture::CutMesh& mesh, std::uint32_t page) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.page_of(t) == page) out.push_back(t);
    return out;
  }
};

// Page 0 with the test pattern, and with images around the sphere.
inline orbis::texture::Image patterned(const orbis::texture::CutMesh& mesh,
                                       const orbis::Progress& progress = orbis::NoProgress(),
                                       std::uint32_t threads = 1) {
  AtlasPage page(mesh, 0, threads);
  return orbis::texture::bake_pattern(page.map, mesh, 0, progress, page.pool);
}
inline orbis::texture::Image surrounded(const orbis::texture::CutMesh& mesh,
                                        std::span<const orbis::texture::Image> images,
                                        const orbis::Progress& progress = orbis::NoProgress(),
                                        std::uint32_t threads = 1) {
  AtlasPage page(mesh, 0, threads);
  return orbis::texture::bake_cube_map(page.map, mesh, images, progress, page.pool);
}

// Calls visit(x, y, triangle, weights) for every texel of page 0, the only one, whose centre lies in a triangle;
// weights are the barycentric coordinates of the centre.
template <class Visit> void rasterize_page(const orbis::texture::CutMesh& mesh, Visit visit) {
  const orbis::texture::Page& page = mesh.pages[0];
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    orbis::texture::rasterize(
        orbis::texture::in_page(mesh, t), page.width, page.height,
        [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) { visit(x, y, t, weights); });
  }
}

// The direction on the sphere that each covered texel of page 0 shows; zero where none does.
inline std::vector<Vec3d> directions(const orbis::texture::CutMesh& mesh) {
  const orbis::texture::Page& page = mesh.pages[0];
  std::vector<Vec3d> out(std::size_t{page.width} * page.height);
  rasterize_page(mesh, [&](std::uint32_t x, std::uint32_t y, std::uint32_t t, const std::array<double, 3>& weights) {
    Vec3d& d = out[std::size_t{y} * page.width + x];
    for (std::size_t k = 0; k < 3; ++k)
      d += Vec3d(orbis::sphere::from_grid(mesh.vertices[mesh.triangles[t][k]].sphere)) * weights[k];
  });
  return out;
}

} // namespace sphere_meshes
