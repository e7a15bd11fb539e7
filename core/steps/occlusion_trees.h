// What hides the sky from the surface: its own triangles, those of each mesh of the document by themselves.
#pragma once

#include <cstdint>
#include <list>
#include <vector>

#include "core/report.h"
#include "core/steps/mask_reader.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/occluders.h"

namespace orbis {

struct OcclusionTrees {
  std::list<MaskTexture> textures;                  // that the trees refer to
  std::vector<texture::OccluderTree> trees;         // one a mesh of the document that has triangles in the result
  std::vector<std::uint32_t> tree_of, component_of; // by delivered triangle
  float offset = 0; // above the surface, where rays start: a hundred thousandth of its size
};

// Caps hide nothing: they are not delivered. Nor does what renderers do not show: what is blended, and what masks leave
// out, where the base colour is the model's own (report.atlas.source); the backs of open components that are seen from
// one side, but to points of the same component.
[[nodiscard]] OcclusionTrees occlusion_trees(const asset::Asset& asset, const Surface& surface,
                                             const texture::CutMesh& cut, const Limits& limits, const Report& report);

} // namespace orbis
