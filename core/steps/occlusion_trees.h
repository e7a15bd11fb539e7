// What hides the sky from the surface: its own triangles, those of each mesh of the document by themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/ray_tree.h"

namespace orbis {

struct OcclusionTrees {
  std::vector<texture::RayTree> trees; // one a mesh of the document that has triangles in the result
  std::vector<std::uint32_t> tree_of;  // by delivered triangle
  float offset = 0;                    // above the surface, where rays start: a hundred thousandth of its size
};

// Caps hide nothing: they are not delivered.
[[nodiscard]] OcclusionTrees occlusion_trees(const Surface& surface, const texture::CutMesh& cut);

} // namespace orbis
