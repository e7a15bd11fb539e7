// The binary container of glTF 2.0 (specification, chapter 4).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "core/asset/asset.h"

namespace orbis::asset {

// True where the bytes begin like a GLB of any version.
[[nodiscard]] bool is_glb(std::span<const std::byte> bytes);

struct GlbChunks {
  std::span<const std::byte> json;
  std::optional<std::span<const std::byte>> bin;
};

// The chunks, as parts of `bytes`. Throws Error: unsupported_format for a version other than 2; malformed where the
// header's length is not the file's, a chunk ends beyond it or off a 4-byte boundary, the first chunk is not JSON, or a
// second chunk of either kind follows. Chunks of other kinds are skipped, as the specification asks.
[[nodiscard]] GlbChunks split_glb(std::span<const std::byte> bytes);

// Joins JSON and binary data, padded to 4 bytes with spaces and zeros. An empty `bin` writes no chunk.
[[nodiscard]] Bytes join_glb(std::string_view json, std::span<const std::byte> bin);

} // namespace orbis::asset
