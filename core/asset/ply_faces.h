// The element "face" of a PLY file as triangles, with what faces and their corners have of their own.
#pragma once

#include <array>

#include "core/asset/ply_vertices.h"

namespace orbis::asset {

struct PlyFaces {
  using Color = std::array<std::uint16_t, 4>; // linear, in parts of 65535

  std::vector<std::uint32_t> indices;  // 3 per triangle
  std::vector<Vec2f> texcoords;        // as many, v downward; none where the faces have none
  std::vector<Color> colors;           // one per triangle, or none
  std::uint32_t color_components = 3;  // 4: with alpha
  std::vector<std::uint32_t> textures; // one per triangle: which of the file's textures, or no_texture; empty: all 0

  static constexpr std::uint32_t no_texture = 0xffffffff;
};

// Polygons become triangles. MeshLab's "texcoord" (a list of u and v for each corner) is read where the vertices have
// no texture coordinates; a face whose list has another length has no texture. "texnumber" chooses one of `textures`,
// another number none. red, green, blue and alpha are read where the vertices have no colours. Other properties get a
// note. Throws Error: malformed, too_large.
[[nodiscard]] PlyFaces read_ply_faces(const PlyElement& element, PlyValues& values, const PlyVertices& vertices,
                                      std::size_t textures, const Limits& limits, std::vector<Asset::Note>& notes);

} // namespace orbis::asset
