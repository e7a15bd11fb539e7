// Rectangles packed into a rectangle, bottom-left under a skyline (Jylanki, A thousand ways to pack the bin, 2010).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace orbis::texture {

struct Extent {
  std::uint32_t width = 0, height = 0;
};

struct Placement {
  std::uint32_t x = 0, y = 0;
  bool turned = false; // by a quarter: width and height change places
};

// Places for all rectangles inside `page` that do not overlap, or nothing where none of three orders found them: by the
// steps of the skyline, and by the rectangles, longest or largest first. Deterministic; O(n * steps of the skyline).
[[nodiscard]] std::optional<std::vector<Placement>> pack(std::span<const Extent> rectangles, const Extent& page);

} // namespace orbis::texture
