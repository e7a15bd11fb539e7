// The element "vertex" of a PLY file as glTF's attributes.
#pragma once

#include "core/asset/asset.h"
#include "core/asset/ply_values.h"

namespace orbis::asset {

struct PlyVertices {
  std::vector<Attribute> attributes; // POSITION first
  Vec3d origin;                      // what positions are measured from (extent.h)

  [[nodiscard]] bool has(std::string_view attribute) const;
};

// Properties that have no place get a note. Throws Error: malformed, invalid_geometry (no x, y and z).
[[nodiscard]] PlyVertices read_ply_vertices(const PlyElement& element, PlyValues& values,
                                            std::vector<Asset::Note>& notes);

// "the vertex property 'quality' is not carried over"
void note_lost_property(const PlyElement& element, const PlyProperty& property, std::vector<Asset::Note>& notes);

// An integer colour's value in [0, 1]: PLY's are as large as their type.
[[nodiscard]] double unit_color(double value, PlyType type);

} // namespace orbis::asset
