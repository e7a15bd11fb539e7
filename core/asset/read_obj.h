// Wavefront OBJ: polygons with texture coordinates, normals, vertex colours and materials.
#pragma once

#include "core/asset/model_builder.h"
#include "core/asset/model_files.h"

namespace orbis::asset {

// Each object ("o") becomes a mesh, with a primitive for each material; groups and smoothing groups are no parts of a
// surface and leave no trace. Corners that agree in position, texture coordinates and normal are one vertex. v is
// turned round, since glTF counts it downward; colours behind a position are taken for sRGB and become linear, and
// positions without one are white where others of their primitive have one. What lies far from the origin is moved
// there, its nodes back (extent.h). Lines, points and curves get a note. Throws Error: malformed with the line,
// too_large, missing_resource.
[[nodiscard]] Converted read_obj(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files);

} // namespace orbis::asset
