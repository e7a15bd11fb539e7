// The full-resolution surface as its levels of detail see it: a map from the atlas to space.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/lod/chart_map.h"
#include "core/mesh/triangle_mesh.h"
#include "core/texture/atlas.h"

namespace orbis::lod {

class FullSurface {
public:
  // surface: the welded mesh that `cut` divides; primitive_of: triangle of `surface` -> primitive. Both meshes outlive
  // this object.
  FullSurface(const mesh::TriangleMesh& surface, std::span<const std::uint32_t> primitive_of,
              const texture::CutMesh& cut);

  [[nodiscard]] const texture::CutMesh& cut() const { return cut_; }
  [[nodiscard]] const mesh::TriangleMesh& surface() const { return surface_; }
  // Cut vertex -> its point in space, scaled so that the bounding box has its centre at 0 and a diagonal of 1.
  [[nodiscard]] std::span<const Vec3d> positions() const { return positions_; }
  // Cut triangle -> number of its region: the triangles of one primitive in one chart. By chart, then by primitive,
  // without gaps.
  [[nodiscard]] std::span<const std::uint32_t> regions() const { return regions_; }
  // Cut triangle -> its unit normal; 0 where it has no area.
  [[nodiscard]] const Vec3d& normal(std::size_t triangle) const { return normals_[triangle]; }
  // Cut triangle -> weight and slip of its quadric (deviation_quadric.h): its area and the usual slip, and more of both
  // where the shading changes quickly. There a texel that is off by r, in whatever direction, shows: the picture is
  // wrong by r times the gradient of the normals.
  struct Weighing {
    double weight = 0, slip = 1;
  };
  [[nodiscard]] const Weighing& weighing(std::size_t triangle) const { return weighings_[triangle]; }
  // Length in space per length in the atlas, as the areas say: uv times this is in the units of positions().
  [[nodiscard]] double uv_scale() const { return uv_scale_; }

  // From scaled coordinates back to the model's.
  [[nodiscard]] Vec3f in_model(const Vec3d& scaled) const { return Vec3f(scaled * diagonal_ + centre_); }
  [[nodiscard]] Vec3d in_scale(const Vec3f& p) const { return (Vec3d(p) - centre_) * (1 / diagonal_); }
  [[nodiscard]] double diagonal() const { return diagonal_; }

  // Whether a vertex of the cut lies where the surface was cut apart: on a rim that coincides with another, as along a
  // loop around a handle. Such points keep their place on every level, or gaps would open there.
  [[nodiscard]] bool is_joint(const texture::CutVertex& vertex) const;
  // The number of the place in space where a vertex of such a rim lies, one for all that coincide; `none` elsewhere,
  // and between two vertices of the surface.
  [[nodiscard]] std::uint32_t joint_of(const texture::CutVertex& vertex) const;

  // What a region's number says.
  [[nodiscard]] std::uint32_t chart_of(std::uint32_t region) const { return meaning_[region].first; }
  [[nodiscard]] std::uint32_t primitive_of(std::uint32_t region) const { return meaning_[region].second; }

  // Places on it by their uv.
  [[nodiscard]] const ChartMap& chart_map() const { return *chart_map_; }

  [[nodiscard]] Vec3d position(const Place& place) const;
  // The place on the welded surface: its weights on the corners of the triangle cut().parent[place.triangle].
  [[nodiscard]] std::array<double, 3> weights_on_parent(const Place& place) const;
  [[nodiscard]] sphere::GridPoint sphere_point(const Place& place) const;

private:
  void scale_positions();
  void find_joints();
  void weigh();
  void number_regions(std::span<const std::uint32_t> primitive_of);

  const mesh::TriangleMesh& surface_;
  const texture::CutMesh& cut_;
  std::vector<Vec3d> positions_, normals_;
  std::vector<Weighing> weighings_;
  std::vector<std::uint32_t> regions_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> meaning_; // of a region: its chart and its primitive
  std::optional<ChartMap> chart_map_;                            // made after the regions
  std::vector<std::uint32_t> joint_; // vertex of the welded surface -> number of its joint, or `none`
  Vec3d centre_;
  double diagonal_ = 1, uv_scale_ = 1;
};

} // namespace orbis::lod
