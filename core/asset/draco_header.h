// What a Draco mesh claims about itself before its connectivity is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace orbis::asset {

struct DracoHeader {
  bool is_mesh = false; // else a point cloud, and the counts are not read
  std::uint64_t faces = 0, vertices = 0;
};

// Reads the header of the Draco bitstream (specification 2.2, section 4; older versions store the counts in 32 bits),
// past metadata if there is any. Nothing where the data ends too early or the method is not known.
[[nodiscard]] std::optional<DracoHeader> read_draco_header(std::span<const std::byte> bytes);

} // namespace orbis::asset
