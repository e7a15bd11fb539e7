// The stages of a job as files to look at: Wavefront OBJ and PNG.
#pragma once

#include <span>
#include <string_view>

#include "core/mesh/triangle_mesh.h"
#include "core/pipeline.h"
#include "core/texture/atlas.h"

namespace orbis {

// Each does nothing where `dump` is empty.
void dump_mesh(const StageDump& dump, std::string_view name, std::span<const Vec3f> positions,
               std::span<const mesh::Triangle> triangles);
// The charts, flat: x, y are their page's texels, y up; pages lie side by side.
void dump_charts(const StageDump& dump, std::string_view name, const texture::CutMesh& cut);
void dump_bytes(const StageDump& dump, std::string_view name, std::span<const std::byte> bytes);

} // namespace orbis
