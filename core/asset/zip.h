// Zip archives of a model and the files that it names.
#pragma once

#include <span>
#include <string>

#include "core/asset/asset.h"

namespace orbis::asset {

struct ZippedModel {
  std::string name; // of the model, in the archive
  Bytes model;
  // The others, by their path from the model's folder; by that in the archive's own bytes too where it is no UTF-8.
  Attachments files;
};

// Takes an archive apart in memory. Exactly one member must have the name of a model (.glb, .gltf, .drc, .obj, .ply,
// .stl). Before anything is inflated: at most 4096 members, as many bytes as limits.max_bytes in all, none that claims
// to be inflated more than 200 times beyond its first MiB, names that stay inside the archive, stored or deflated, not
// encrypted. What a member claims is held against what comes out, and against its checksum.
// Throws Error: malformed, too_large, unsupported_feature (encrypted, another method, several models), missing_resource
// (no model).
[[nodiscard]] ZippedModel unzip_model(std::span<const std::byte> bytes, const Limits& limits);

} // namespace orbis::asset
