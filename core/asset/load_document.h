// From a checked JSON document to a Document: buffers, decoded views and images.
#pragma once

#include "core/asset/document.h"
#include "core/asset/model_files.h"

namespace orbis::asset {

// `bin` is the GLB's binary chunk, if there is one. `json` has passed check_document. Buffers whose bytes nothing
// refers to (fallbacks of compressed views) need not be there. Throws Error: missing_resource that names the URI,
// malformed, too_large (decoded data), unsupported_feature (meshopt).
[[nodiscard]] Document load_document(Json json, std::optional<std::span<const std::byte>> bin, const ModelFiles& files,
                                     const Limits& limits);

// Bytes of vertex data that may come out of compressed or shared data. A vertex of a skinned, textured model with a
// handful of morph targets has some 128.
[[nodiscard]] std::uint64_t max_decoded_bytes(const Limits& limits);

} // namespace orbis::asset
