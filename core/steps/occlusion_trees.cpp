#include "core/steps/occlusion_trees.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/asset/materials.h"

namespace orbis {
namespace {

float size_of(const std::vector<Vec3f>& positions) {
  Vec3f low = positions.front(), high = low;
  for (const Vec3f& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

// The triangles of one mesh of the document.
struct Mesh {
  std::vector<mesh::Triangle> triangles;
  std::vector<texture::Occluder> occluders;
  std::vector<texture::AlphaMask> masks;
};

class Collector {
public:
  Collector(const asset::Asset& asset, const Surface& surface, const Limits& limits, const Report& report)
      : surface_(surface), report_(report), read_mask_(asset, surface, limits) {
    const bool has_own_alpha = report.atlas.source == "base_color" || report.atlas.source == "none";
    for (const asset::Primitive& p : asset.primitives) {
      alpha_.push_back(has_own_alpha ? asset::alpha_of(asset, p).mode : AlphaMode::opaque);
      shows_backs_.push_back(asset::shows_back_faces(asset, p));
    }
  }

  void add(std::uint32_t component) {
    const Component& c = surface_.components[component];
    const bool is_closed = report_.components[c.number].boundary_loops == 0;
    Mesh& mesh = meshes_[c.mesh];
    for (std::uint32_t t = c.first_triangle; t < c.end_triangle(); ++t) {
      if (surface_.is_cap(t)) continue;
      const std::uint32_t p = surface_.primitive_of[t];
      if (alpha_[p] == AlphaMode::blend) continue;
      texture::Occluder occluder{component, is_closed || shows_backs_[p]};
      if (alpha_[p] == AlphaMode::mask) {
        occluder.mask = static_cast<std::uint32_t>(mesh.masks.size());
        mesh.masks.push_back(read_mask_(t));
      }
      mesh.triangles.push_back(surface_.mesh.triangles[t]);
      mesh.occluders.push_back(occluder);
    }
  }

  [[nodiscard]] std::map<std::uint32_t, Mesh>& meshes() { return meshes_; } // by their number
  [[nodiscard]] std::list<MaskTexture> take_textures() { return read_mask_.take_textures(); }

private:
  using AlphaMode = texture::AlphaMode;

  const Surface& surface_;
  const Report& report_;
  MaskReader read_mask_;
  std::vector<AlphaMode> alpha_;  // by primitive
  std::vector<bool> shows_backs_; // by primitive
  std::map<std::uint32_t, Mesh> meshes_;
};

} // namespace

OcclusionTrees occlusion_trees(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                               const Limits& limits, const Report& report) {
  Collector collector(asset, surface, limits, report);
  std::vector<std::uint32_t> component_of(surface.mesh.triangles.size());
  for (std::uint32_t number = 0; number < surface.components.size(); ++number) {
    const Component& c = surface.components[number];
    std::fill_n(component_of.begin() + c.first_triangle, c.triangles, number);
    collector.add(number);
  }
  OcclusionTrees out;
  std::map<std::uint32_t, std::uint32_t> tree_of;
  for (auto& [number, mesh] : collector.meshes()) {
    tree_of[number] = static_cast<std::uint32_t>(out.trees.size());
    out.trees.emplace_back(surface.mesh.positions, mesh.triangles, std::move(mesh.occluders), std::move(mesh.masks));
  }
  for (const std::uint32_t parent : cut.parent) {
    out.component_of.push_back(component_of[parent]);
    out.tree_of.push_back(tree_of.at(surface.components[component_of[parent]].mesh));
  }
  out.textures = collector.take_textures();
  constexpr float part = 1e-5F;
  out.offset = part * size_of(surface.mesh.positions);
  return out;
}

} // namespace orbis
