// What can be said of options before any file is read: whether they go together, and whether what they need is there.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/options.h"

namespace orbis {

// Throws Error for options that cannot work: missing_resource where a file that they need is not among `files`, the
// names of those that came with the model (texture, morph_to); invalid_option for one that another rules out
// (sphere_morph with morph_to) or lacks (features without it).
void check_options(const Options& options, std::span<const std::string_view> files);

// Those of the files that texture=cubemap shows, whatever their endings: the one named "equirectangular", or else six
// in the order of the cube's faces, "px", "nx", "py", "ny", "pz", "nz". Throws Error{missing_resource} that names the
// first that is not there.
[[nodiscard]] std::vector<std::string_view> cube_map_files(std::span<const std::string_view> files);

} // namespace orbis
