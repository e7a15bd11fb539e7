// A mesh on the atlas, page by page.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/groups.h"
#include "core/mesh/thread_pool.h"
#include "core/texture/atlas.h"
#include "core/texture/texel_map.h"

namespace orbis {

// Sorted once, so that what is done for each page looks at what is on it alone.
class MeshByPage {
public:
  // Keeps a reference.
  explicit MeshByPage(const texture::CutMesh& cut);

  [[nodiscard]] std::span<const std::uint32_t> triangles(std::uint32_t page) const { return triangles_[page]; }
  [[nodiscard]] std::span<const std::uint32_t> charts(std::uint32_t page) const { return charts_[page]; }
  // For as long as this lives.
  [[nodiscard]] texture::PageMesh mesh(std::uint32_t page) const;
  // Which triangle each texel of the page shows.
  [[nodiscard]] texture::TexelMap map(std::uint32_t page, mesh::ThreadPool& pool) const;

private:
  const texture::CutMesh& cut_;
  std::vector<Vec2f> uv_; // by vertex
  mesh::Groups triangles_, charts_;
};

} // namespace orbis
