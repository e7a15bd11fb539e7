#include "core/steps/mesh_by_page.h"

namespace orbis {

MeshByPage::MeshByPage(const texture::CutMesh& cut)
    : cut_(cut), triangles_(cut.triangles.size(), cut.pages.size(), [&](std::uint32_t t) { return cut.page_of(t); }),
      charts_(cut.charts.size(), cut.pages.size(), [&](std::uint32_t c) { return cut.charts[c].page; }) {
  uv_.reserve(cut.vertices.size());
  for (const texture::CutVertex& v : cut.vertices) uv_.push_back(v.uv);
}

texture::PageMesh MeshByPage::mesh(std::uint32_t page) const { return {uv_, cut_.triangles, triangles_[page]}; }

texture::TexelMap MeshByPage::map(std::uint32_t page, mesh::ThreadPool& pool) const {
  return {mesh(page), cut_.pages[page].width, cut_.pages[page].height, pool};
}

} // namespace orbis
