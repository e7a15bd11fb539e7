// The file formats of models, recognised by content: names and media types are often wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace orbis {

enum class ModelFormat { glb, gltf, draco, obj, ply, stl, zip };

// "glb", "gltf", "draco", "obj", "ply", "stl" or "zip".
[[nodiscard]] std::string_view name_of(ModelFormat format);

// Bytes of a file that are enough for recognise().
inline constexpr std::uint64_t format_head_bytes = 4096;

// The format of a file of `size` bytes that begins with `head`: format_head_bytes of it, or all. Nothing where it is
// none. Formats without a mark of their own are told by what must be in them: a binary STL by its size, an OBJ by the
// first line that is neither empty nor a comment (where the head holds comments alone, it passes for an OBJ).
[[nodiscard]] std::optional<ModelFormat> recognise(std::string_view head, std::uint64_t size);

// What is said of a file that recognise() knows nothing of. A file with bytes that are no text may be a binary STL that
// was cut off or added to: where its size is near what its count says, at most a factor of 2 away, both are told.
[[nodiscard]] std::string unrecognised(std::string_view head, std::uint64_t size);

// A binary STL is 80 bytes of anything, a count, and 50 bytes a triangle. Some begin with "solid" like the textual
// ones, so that the size decides.
[[nodiscard]] bool is_binary_stl(std::string_view head, std::uint64_t size);

} // namespace orbis
