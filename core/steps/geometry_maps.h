// The maps that are made of the geometry: normals, ambient occlusion, positions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/steps/mesh_by_page.h"
#include "core/steps/occlusion_trees.h"
#include "core/steps/page_baking.h"
#include "core/steps/tangent_frames.h"
#include "core/texture/bake_maps.h"

namespace orbis {

// Bakes into the page that is open, and lets the delivered primitives show the result.
class GeometryMaps {
public:
  // Keeps references to both.
  GeometryMaps(const BakeJob& job, PageBaking& page);

  // In tangent space, for the full surface and, where there are any, for its levels of detail; in the space of POSITION
  // where that is asked for.
  void bake_normals();
  // In as many texels as the bound on the rays allows.
  void bake_ambient_occlusion();
  void bake_positions();
  // One map for each level of detail, "displacement_lod1" first; a note where there are none.
  void bake_displacements();

private:
  [[nodiscard]] std::vector<bool> two_sided_triangles() const;
  void bake_displacement_of(std::size_t number, const std::string& name);
  [[nodiscard]] std::vector<bool> takes_normal_map(const SlotTextures& textures) const;
  [[nodiscard]] std::vector<bool> levels_take_normal_map(const std::vector<bool>& full) const;
  [[nodiscard]] std::vector<std::uint32_t> delivered_triangles(const std::vector<bool>& wanted) const;
  void deliver_frames(std::span<const std::uint32_t> triangles, const TangentFrames& frames,
                      const std::vector<bool>& wanted);
  [[nodiscard]] texture::FrameField field_of(const TangentFrames& frames) const;
  void follow(const texture::SmoothFrames& smooth, const std::vector<bool>& wanted);
  void bake_normals_of_levels(const texture::NormalSource& source, const std::vector<bool>& wanted);
  std::uint32_t add_normals(const std::string& name, const texture::NormalSource& source, const TangentFrames& frames);
  std::uint32_t add_normals(const std::string& name, const texture::NormalSource& source,
                            const texture::FrameField* frames, bool shown);

  // A level of detail, and what displacements are measured from: its vertices as delivered, those of the page that is
  // open.
  struct LevelOnPages {
    MeshByPage by_page;
    std::vector<Vec3f> positions, normals;
  };

  const BakeJob& job_;
  PageBaking& page_;
  SlotTextures normal_;
  FrameFinder frames_;
  std::vector<LevelOnPages> levels_;
  // Made when needed.
  std::optional<OcclusionTrees> trees_;
  std::optional<std::vector<bool>> two_sided_; // by triangle of the cut
  std::optional<texture::Box> box_;
};

} // namespace orbis
