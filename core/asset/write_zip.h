// A zip archive of several files.
#pragma once

#include <span>
#include <string>

#include "core/asset/asset.h"

namespace orbis::asset {

struct ZipMember {
  std::string name;
  Bytes bytes;
};

// The members are stored as they are (GLBs of images and floats hardly shrink), in their order, with one fixed date:
// the same members give the same bytes.
[[nodiscard]] Bytes write_zip(std::span<const ZipMember> members);

} // namespace orbis::asset
