// The tangent frames of the delivered triangles: what their normal map is written in, and what a renderer rebuilds.
#pragma once

#include <vector>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/steps/delivery.h"
#include "core/texture/atlas.h"
#include "core/texture/smooth_frames.h"
#include "core/texture/tangents.h"

namespace orbis {

struct TangentFrames {
  std::vector<Vec3f> normals;             // by cut vertex, unit, as delivered in NORMAL
  std::vector<texture::Tangent> tangents; // by cut vertex, as delivered in TANGENT
};

// Gives the primitives that are `wanted` NORMAL, where they have none (smooth over the surface, by the angles of the
// triangles around each point), and TANGENT along the atlas' texture coordinates, by MikkTSpace. Morph targets lose
// their TANGENT, which belonged to the old ones; that is noted.
TangentFrames add_tangent_frames(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                                 const std::vector<bool>& wanted, Delivery& delivery, Report& report);

// Unit, by vertex: the normals of the triangles around it, weighted by their angles there; (0, 0, 1) where there are
// none.
[[nodiscard]] std::vector<Vec3d> smooth_normals(const mesh::TriangleMesh& mesh);

// Overwrites NORMAL and TANGENT of one vertex of the output.
void set_frame(asset::NewPrimitive& primitive, std::size_t vertex, const texture::VertexFrame& frame);

} // namespace orbis
