// Polygon files (G. Turk, The PLY Polygon File Format, 1994), textual and binary of either byte order.
#pragma once

#include "core/asset/model_builder.h"
#include "core/asset/model_files.h"

namespace orbis::asset {

// The elements "vertex" (x, y, z; nx, ny, nz; red, green, blue and alpha; s, t or their other names) and "face" (a list
// of vertices; polygons become triangles; MeshLab's texcoord and texnumber; colours), and the textures that MeshLab
// names in comments, a primitive for each. What vertices have comes before what faces have of the same. Integer colours
// are taken for sRGB and become linear, as glTF has them; v is turned round, since glTF counts it downward. What lies
// far from the origin is moved there, its node back (extent.h). What else there is gets a note. Throws
// Error: malformed, too_large, missing_resource, unsupported_feature (faces before vertices), invalid_geometry (no
// vertices or no faces: a point cloud).
[[nodiscard]] Converted read_ply(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files);

} // namespace orbis::asset
