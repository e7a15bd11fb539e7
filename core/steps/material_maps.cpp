#include "core/steps/material_maps.h"

#include <algorithm>

#include "core/steps/paint.h"
#include "core/texture/bake_maps.h"

namespace orbis {
namespace {

using asset::TextureSlot;
using texture::Encoding;
using texture::Image;

bool read_alike(const std::optional<asset::MaterialTexture>& a, const std::optional<asset::MaterialTexture>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->image_number == b->image_number && a->uv == b->uv && a->wrap_s == b->wrap_s && a->wrap_t == b->wrap_t &&
         a->nearest == b->nearest && a->transform == b->transform;
}

bool has_alpha(const std::vector<texture::TextureSource>& sources) {
  return std::ranges::any_of(sources, [](const auto& s) { return s.image != nullptr && s.image->channels == 4; });
}

bool has_alpha(const asset::Attribute& color) {
  for (std::size_t v = 0; color.components == 4 && v < color.count(); ++v)
    if (color.get(v, 3) < 1) return true;
  return false;
}

// COLOR_n would be multiplied with the base colour: as _COLOR_n it is only kept.
void set_colors_aside(asset::NewPrimitive& primitive) {
  for (asset::Attribute& a : primitive.attributes) {
    if (a.name.starts_with("COLOR_")) a.name = "_" + a.name;
  }
  for (auto& target : primitive.targets) {
    std::erase_if(target, [](const asset::Attribute& a) { return a.name.starts_with("COLOR_"); });
  }
}

} // namespace

MaterialMaps::MaterialMaps(const BakeJob& job, PageBaking& page)
    : job_(job), page_(page), base_color_(job.asset.primitives.size()), colored_(job.asset.primitives.size()) {
  if (may_show_own_colors(job.options())) {
    base_color_ = textures_of(job.asset, job.delivery, TextureSlot::base_color, job.report);
    colored_ = bakes_vertex_colors(job.asset, job.delivery);
    leave_colors_of_kept_textures(base_color_);
  }
  const bool has_own = any(base_color_) || any(colored_);
  job.report.atlas.source = source_name(job.options(), has_own);
  // Where the model has textures that cannot be read here, they stay: no pattern goes over them.
  const bool keeps_own = job.options().texture == TextureSource::automatic && names_base_color();
  if (!has_own && keeps_own) job.report.atlas.source = "none";
  shows_own_ = has_own || keeps_own;
  uploaded_ = uploaded_images(job.request, job.limits);
  metallic_roughness_ = planned(Map::metallic_roughness, TextureSlot::metallic_roughness);
  occlusion_ = planned(Map::occlusion, TextureSlot::occlusion);
  emissive_ = planned(Map::emissive, TextureSlot::emissive);
}

bool MaterialMaps::names_base_color() const {
  return std::ranges::any_of(job_.asset.primitives, [this](const asset::Primitive& p) {
    return asset::names_texture(job_.asset, p, TextureSlot::base_color);
  });
}

// A texture that is not baked stays, and is multiplied with the vertex colours as before.
void MaterialMaps::leave_colors_of_kept_textures(const SlotTextures& baked) {
  for (std::size_t p = 0; p < colored_.size(); ++p)
    if (!baked[p] && asset::names_texture(job_.asset, job_.asset.primitives[p], TextureSlot::base_color))
      colored_[p] = false;
}

bool MaterialMaps::colors_have_alpha(const std::vector<bool>& colored) const {
  for (std::size_t p = 0; p < colored.size(); ++p)
    if (colored[p] && page_.shows(p) && has_alpha(*job_.asset.primitives[p].find("COLOR_0"))) return true;
  return false;
}

SlotTextures MaterialMaps::planned(Map map, TextureSlot slot) const {
  if (!job_.wants(map)) return SlotTextures(job_.asset.primitives.size());
  SlotTextures textures = textures_of(job_.asset, job_.delivery, slot, job_.report);
  if (!any(textures) && job_.options().maps.names(map)) {
    job_.report.notes.push_back(
        {"map-not-baked", "no material has a texture that the map could be baked from", std::string(name_of(map))});
  }
  return textures;
}

void MaterialMaps::bake_base_color() {
  SlotTextures textures = page_.shown(base_color_);
  const bool strict = job_.options().texture == TextureSource::base_color;
  const SlotTextures named = textures;
  const DecodedImages images = page_.images().decode(strict, textures);
  for (std::size_t p = 0; p < named.size(); ++p)
    if (named[p] && !textures[p]) colored_[p] = false;
  std::vector<bool> takes(textures.size());
  for (std::size_t p = 0; p < takes.size(); ++p) {
    takes[p] = page_.shows(p) && (!shows_own_ || textures[p].has_value() || colored_[p]);
  }
  Image image =
      shows_own_ ? resample(textures, images, colored_, Encoding::srgb)
                 : paint(uploaded_, page_.delivered_map(), job_.shown.cut, page_.page(), job_.progress, page_.pool());
  if (job_.wants(Map::base_color) && any(takes)) {
    show_base_color(takes, page_.add(image, MapKind::color, "base_color"));
  }
  page_.keep_base_color(std::move(image));
}

void MaterialMaps::show_base_color(const std::vector<bool>& takes, std::uint32_t number) {
  for (std::size_t p = 0; p < takes.size(); ++p) {
    if (!takes[p]) continue;
    asset::NewPrimitive& primitive = job_.delivery.primitives[p];
    primitive.textures[TextureSlot::base_color] = number;
    primitive.plain_base_color = !shows_own_;
    if (shows_own_ && !colored_[p]) continue;
    set_colors_aside(primitive);
    for (DetailLevel& level : job_.levels) set_colors_aside(level.delivery.primitives[p]);
  }
}

void MaterialMaps::bake_metallic_roughness_and_occlusion() {
  SlotTextures metals = page_.shown(metallic_roughness_), occlusion = page_.shown(occlusion_);
  const bool alike = std::ranges::equal(metals, occlusion, read_alike);
  const DecodedImages metals_images = page_.images().decode(false, metals);
  if (alike) occlusion = metals;
  const DecodedImages occlusion_images = alike ? DecodedImages{} : page_.images().decode(false, occlusion);
  if (!any(metals) && !any(occlusion)) return;
  Image image = any(metals) ? resample(metals, metals_images, {}, Encoding::linear)
                            : resample(occlusion, occlusion_images, {}, Encoding::linear);
  if (any(metals) && any(occlusion) && !alike) {
    const Image red = resample(occlusion, occlusion_images, {}, Encoding::linear);
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) image.pixels[i] = red.pixels[i];
  }
  const char* const name = !any(occlusion) ? "metallic_roughness"
                           : !any(metals)  ? "occlusion"
                                           : "occlusion_roughness_metallic";
  const std::uint32_t number = page_.add(image, MapKind::data, name);
  show(metals, TextureSlot::metallic_roughness, number);
  show(occlusion, TextureSlot::occlusion, number);
}

void MaterialMaps::bake_emissive() {
  SlotTextures textures = page_.shown(emissive_);
  const DecodedImages images = page_.images().decode(false, textures);
  if (!any(textures)) return;
  const Image image = resample(textures, images, {}, Encoding::srgb);
  show(textures, TextureSlot::emissive, page_.add(image, MapKind::color, "emissive"));
}

void MaterialMaps::show(const SlotTextures& textures, TextureSlot slot, std::uint32_t number) {
  for (std::size_t p = 0; p < textures.size(); ++p) {
    if (textures[p]) job_.delivery.primitives[p].textures[slot] = number;
  }
}

Image MaterialMaps::resample(const SlotTextures& textures, const DecodedImages& images,
                             const std::vector<bool>& colored, Encoding encoding) {
  const std::span<const texture::CornerUv> uv = page_.source_uv(textures);
  const std::vector<texture::TextureSource> sources = sources_of(textures, images);
  const texture::TextureReader reader(page_.map(), page_.values().shown(), uv, page_.primitive_of(), sources, encoding);
  std::span<const texture::CornerColor> colors;
  if (any(colored)) colors = page_.values().colors(colored);
  const bool alpha = encoding == Encoding::srgb && (has_alpha(sources) || colors_have_alpha(colored));
  return texture::bake_texture(page_.map(), reader, colors, encoding, alpha, job_.progress, page_.pool());
}

} // namespace orbis
