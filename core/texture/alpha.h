// What the alpha of a surface's base colour means.
#pragma once

#include <cstdint>

namespace orbis::texture {

// As glTF 2.0 section 3.9.4 says: opaque: nothing; mask: what has less than the cutoff is not there; blend: how much of
// what lies behind is hidden.
enum class AlphaMode : std::uint8_t { opaque, mask, blend };

struct Alpha {
  AlphaMode mode = AlphaMode::opaque;
  float cutoff = 0.5F;
};

} // namespace orbis::texture
