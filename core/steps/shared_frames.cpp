#include "core/steps/shared_frames.h"

#include <algorithm>

namespace orbis {
namespace {

std::vector<Vec2f> uv_of(const texture::CutMesh& mesh) {
  std::vector<Vec2f> out;
  for (const texture::CutVertex& v : mesh.vertices) out.push_back(v.uv);
  return out;
}

// The triangles of the level that show shared primitives on the page. Its charts are those of the full surface.
std::vector<std::uint32_t> shown_on(const Surface& surface, const texture::CutMesh& cut, std::uint32_t page,
                                    const std::vector<bool>& shared, const texture::CutMesh& level) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < level.triangles.size(); ++t) {
    const bool on_page = cut.charts[level.chart[t]].page == page;
    if (on_page && shared[surface.primitive_of[level.parent[t]]]) out.push_back(t);
  }
  return out;
}

std::uint32_t texel(float coordinate, std::uint32_t size) {
  const double at = static_cast<double>(coordinate) * size;
  return at > 0 ? std::min(static_cast<std::uint32_t>(at), size - 1) : 0;
}

} // namespace

SharedFrames::SharedFrames(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                           std::uint32_t page, std::vector<bool> shared, DetailLevel& coarsest,
                           const texture::TexelMap& map, mesh::ThreadPool& pool)
    : shared_(std::move(shared)), mesh_(coarsest.level.mesh), uv_(uv_of(mesh_)),
      shown_(shown_on(surface, cut, page, shared_, mesh_)),
      map_({uv_, mesh_.triangles, shown_}, map.width(), map.height(), pool) {
  Report already_noted; // of the full surface
  frames_ = add_tangent_frames(asset, surface, mesh_, shared_, coarsest.delivery, already_noted);
}

void SharedFrames::give_to(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& mesh,
                           Delivery& delivery) const {
  Report already_noted;                                                       // of the full surface
  add_tangent_frames(asset, surface, mesh, shared_, delivery, already_noted); // makes the attributes
  const texture::FrameField frames = field();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    if (!shared_[o.primitive]) continue;
    const Vec2f& uv = mesh.vertices[v].uv;
    set_frame(delivery.primitives[o.primitive], o.vertex,
              texture::frame_of(frames, texel(uv.x, map_.width()), texel(uv.y, map_.height()),
                                double{uv.x} * map_.width(), double{uv.y} * map_.height()));
  }
}

} // namespace orbis
