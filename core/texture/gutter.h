// Texels between the charts: filled from the nearest one that shows the surface, so that bilinear and mip-mapped reads
// at a chart's border see no foreign colour.
#pragma once

#include <cstdint>
#include <vector>

#include "core/texture/atlas.h"
#include "core/texture/image.h"

namespace orbis::texture {

class Gutters {
public:
  Gutters(const CutMesh& mesh, std::uint32_t page);

  // image: of the page's size, any number of channels. Every texel that no triangle covers becomes a copy of the
  // nearest one that is covered.
  void fill(Image& image) const;

  // Calls copy(to, from) for each such texel, in an order in which `from` is final; texels are numbered row by row.
  template <class Copy> void for_each(Copy copy) const {
    for (const Fill& f : fills_) copy(f.to, f.from);
  }

private:
  struct Fill {
    std::uint32_t to, from;
  };
  std::vector<Fill> fills_;
};

} // namespace orbis::texture
