// The maps that are made of the geometry: normals, ambient occlusion, positions.
#pragma once

#include <optional>
#include <string>
#include <vector>

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
  [[nodiscard]] std::vector<bool> two_sided_triangles() const; // by triangle of the cut
  void bake_displacement_of(const DetailLevel& level, const std::string& name);
  [[nodiscard]] std::vector<bool> takes_normal_map(const SlotTextures& textures) const;
  [[nodiscard]] std::vector<bool> levels_take_normal_map(const std::vector<bool>& full) const;
  [[nodiscard]] TangentFrames frames_of_full(const std::vector<bool>& wanted, Delivery& delivery, Report& report) const;
  [[nodiscard]] texture::FrameField field_of(const TangentFrames& frames) const;
  void bake_normals_of_levels(const texture::NormalSource& source, const std::vector<bool>& wanted);
  std::uint32_t add_normals(const std::string& name, const texture::NormalSource& source, const TangentFrames& frames);
  std::uint32_t add_normals(const std::string& name, const texture::NormalSource& source,
                            const texture::FrameField* frames, bool shown);

  const BakeJob& job_;
  PageBaking& page_;
  SlotTextures normal_;
  std::optional<OcclusionTrees> trees_;
};

} // namespace orbis
