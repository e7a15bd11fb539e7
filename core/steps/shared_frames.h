// Tangent frames that all levels of detail share, so that one normal map serves them all.
#pragma once

#include <cstdint>
#include <vector>

#include "core/steps/delivery.h"
#include "core/steps/levels.h"
#include "core/steps/tangent_frames.h"
#include "core/texture/bake_maps.h"
#include "core/texture/texel_map.h"

namespace orbis {

// The frames of the coarsest level, as a field over a page. They are smooth where the full surface is rough, so every
// level can follow them with the few vertices that it has.
class SharedFrames {
public:
  // Gives the coarsest level's primitives that are `shared` NORMAL and TANGENT. cut, map: of the full surface. Keeps
  // references to the coarsest level.
  SharedFrames(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut, std::uint32_t page,
               std::vector<bool> shared, DetailLevel& coarsest, const texture::TexelMap& map, mesh::ThreadPool& pool);

  // Gives a finer level's vertices the frame that the field has at their texture coordinates.
  void give_to(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& mesh,
               Delivery& delivery) const;

  [[nodiscard]] texture::FrameField field() const {
    return {&map_, mesh_.triangles, frames_.normals, frames_.tangents};
  }

private:
  std::vector<bool> shared_;
  const texture::CutMesh& mesh_;
  TangentFrames frames_;
  std::vector<Vec2f> uv_;
  std::vector<std::uint32_t> shown_;
  texture::TexelMap map_;
};

} // namespace orbis
