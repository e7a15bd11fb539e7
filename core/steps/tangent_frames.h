// The tangent frames of the delivered triangles: what their normal map is written in, and what a renderer rebuilds.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/steps/delivery.h"
#include "core/texture/atlas.h"
#include "core/texture/smooth_frames.h"
#include "core/texture/tangents.h"

namespace orbis {

struct TangentFrames {
  std::vector<Vec3f> normals;             // by cut vertex, unit
  std::vector<texture::Tangent> tangents; // by cut vertex
};

// Finds the frames of the surface part by part: a part takes as long as it has triangles.
class FrameFinder {
public:
  // Keeps references to both.
  FrameFinder(const Surface& surface, const texture::CutMesh& cut);

  // Fills the entries of the part's vertices; others keep what they had. Normals are NORMAL as delivered or, where a
  // primitive has none, smooth over the surface, by the angles of the triangles around each point. Tangents run along
  // the atlas' texture coordinates, by MikkTSpace. part: triangles of the cut mesh, whole primitives.
  TangentFrames& find(std::span<const std::uint32_t> part, const Delivery& delivery);

private:
  [[nodiscard]] Vec3f smooth_normal(const texture::CutVertex& v);
  [[nodiscard]] std::vector<mesh::Index> vertices_of(std::span<const std::uint32_t> part) const;

  const Surface& surface_;
  const texture::CutMesh& cut_;
  TangentFrames frames_;
  std::optional<std::vector<Vec3d>> smooth_; // by vertex of the surface; made when needed
};

// Where a primitive's frames are written.
struct FrameAttributes {
  asset::Attribute *normal = nullptr, *tangent = nullptr;
  bool normal_is_new = false;

  void set(std::size_t vertex, const texture::VertexFrame& frame) const;
  void set_tangent(std::size_t vertex, const texture::Tangent& tangent) const;
};

// Gives the primitives that are `wanted` NORMAL, where they have none, and TANGENT, to be filled: vertices of triangles
// that only ride along keep (0, 0, 1) and (1, 0, 0). Morph targets lose their TANGENT, which belonged to the old
// texture coordinates; that is noted. By primitive, null where it is not wanted; good until attributes are added.
[[nodiscard]] std::vector<FrameAttributes>
add_frame_attributes(const asset::Asset& asset, const std::vector<bool>& wanted, Delivery& delivery, Report& report);

// Unit, by vertex: the normals of the triangles around it, weighted by their angles there; (0, 0, 1) where there are
// none.
[[nodiscard]] std::vector<Vec3d> smooth_normals(const mesh::TriangleMesh& mesh);

} // namespace orbis
