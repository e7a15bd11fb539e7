// The proof that no two places of a surface share a place in the atlas (docs/atlas.md).
#pragma once

#include <cstdint>
#include <string>

#include "core/texture/atlas.h"

namespace orbis::texture {

struct AtlasCertificate {
  std::uint64_t triangles = 0, charts = 0;
  std::uint64_t off_grid = 0;  // vertices with a texture coordinate that is not a multiple of 2^-24 in [0, 1]
  std::uint64_t folded = 0;    // triangles whose exact orientation in the atlas is not positive
  std::uint64_t outside = 0;   // triangles that leave their chart's rectangle
  std::uint64_t too_close = 0; // pairs of charts of one page whose rectangles come closer than two gutters
  // Charts whose boundary lies all on their rectangle's sides: there the exact areas must add up to the rectangle.
  // Nothing can then be covered twice, since what is covered is covered equally often everywhere.
  std::uint64_t closed_charts = 0, not_filled = 0;
  // The others, of surfaces with holes: there no texel's centre may lie in two triangles.
  std::uint64_t open_charts = 0, shared_texels = 0;
  bool valid = false; // all of it holds

  // One sentence for a person that names the first thing that fails; empty where valid.
  [[nodiscard]] std::string failure() const;
};

// mesh: with the texture coordinates that were delivered.
[[nodiscard]] AtlasCertificate certify_atlas(const CutMesh& mesh);

} // namespace orbis::texture
