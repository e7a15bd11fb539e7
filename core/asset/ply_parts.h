// A PLY file's triangles as glTF's primitives, whose attributes belong to vertices alone.
#pragma once

#include "core/asset/ply_faces.h"

namespace orbis::asset {

struct PlyPart {
  std::uint32_t texture = 0; // one of the file's, or PlyFaces::no_texture
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;
};

// A part for each texture, those without one last. Where the faces have texture coordinates or colours of their own, a
// vertex becomes as many as its corners have different ones, in the order in which triangles come to them; else all
// vertices stay as they are. What has no texture goes without the faces' texture coordinates.
[[nodiscard]] std::vector<PlyPart> ply_parts(PlyVertices vertices, PlyFaces faces);

} // namespace orbis::asset
