// The maps that take the place of the materials' own textures: colours and data, re-sampled texel by texel.
#pragma once

#include <vector>

#include "core/steps/page_baking.h"

namespace orbis {

// Bakes into the page that is open, and lets the delivered primitives show the result.
class MaterialMaps {
public:
  // Finds out what there is to bake from; a map that was asked for by name and has nothing to show is noted. Keeps
  // references to both. Throws Error as bake_maps() says.
  MaterialMaps(const BakeJob& job, PageBaking& page);

  // The model's own colours, or a pattern or uploaded images (paint.h).
  void bake_base_color();
  // Occlusion is stored in red, roughness in green, metalness in blue: one image for both where both are there.
  void bake_metallic_roughness_and_occlusion();
  void bake_emissive();

private:
  [[nodiscard]] bool names_base_color() const;
  void leave_colors_of_kept_textures(const SlotTextures& baked);
  [[nodiscard]] bool colors_have_alpha(const std::vector<bool>& colored) const;
  [[nodiscard]] SlotTextures planned(Map map, asset::TextureSlot slot) const;
  [[nodiscard]] texture::Image resample(const SlotTextures& textures, const DecodedImages& images,
                                        const std::vector<bool>& colored, texture::Encoding encoding);
  void show(const SlotTextures& textures, asset::TextureSlot slot, std::uint32_t number);
  void show_base_color(const std::vector<bool>& takes, std::uint32_t number);

  const BakeJob& job_;
  PageBaking& page_;
  SlotTextures base_color_, metallic_roughness_, occlusion_, emissive_;
  std::vector<bool> colored_; // by primitive: its vertex colours are baked
  bool shows_own_ = false;    // the base colour is the model's own
  std::vector<texture::Image> uploaded_;
};

} // namespace orbis
