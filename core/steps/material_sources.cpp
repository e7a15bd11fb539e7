#include "core/steps/material_sources.h"

#include <algorithm>
#include <array>

#include "core/asset/image_codec.h"

namespace orbis {
namespace {

constexpr std::array<std::string_view, asset::texture_slots> slot_names{"base colour", "metallic-roughness",
                                                                        "occlusion", "emissive", "normal"};

std::string name_of_slot(asset::TextureSlot slot) { return std::string(slot_names[static_cast<std::size_t>(slot)]); }

void note_kept(Report& report, const std::string& why, const std::string& where) {
  report.notes.push_back({"texture-kept", why + "; it stays as it is, with its own texture coordinates", where});
}

bool all_white(const asset::Attribute& color) {
  for (std::size_t v = 0; v < color.count(); ++v) {
    for (std::uint32_t c = 0; c < color.components; ++c) {
      if (color.get(v, c) < 1) return false;
    }
  }
  return true;
}

bool morphs_color(const asset::Primitive& p) {
  return std::ranges::any_of(p.targets, [](const auto& target) {
    return std::ranges::any_of(target, [](const asset::Attribute& a) { return a.name == "COLOR_0"; });
  });
}

} // namespace

std::string pointer_to(const asset::Primitive& p) {
  return "/meshes/" + std::to_string(p.mesh) + "/primitives/" + std::to_string(p.primitive);
}

SlotTextures textures_of(const asset::Asset& asset, const Delivery& delivery, asset::TextureSlot slot, Report& report) {
  SlotTextures out(asset.primitives.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    const asset::Primitive& primitive = asset.primitives[p];
    if (delivery.primitives[p].indices.empty()) continue;
    out[p] = asset::material_texture(asset, primitive, slot);
    if (!out[p] && asset::names_texture(asset, primitive, slot)) {
      note_kept(report,
                "the " + name_of_slot(slot) +
                    " texture was not baked: its image or its coordinates did not come, or "
                    "its format is not decoded here",
                pointer_to(primitive));
    }
  }
  return out;
}

std::shared_ptr<const texture::Image> ImageDecoder::image(const asset::MaterialTexture& texture,
                                                          const std::string& where) {
  if (const auto kept = kept_.find(texture.image_number); kept != kept_.end()) return kept->second;
  auto out =
      std::make_shared<const texture::Image>(asset::decode_image(texture.image, limits_.max_image_pixels, where));
  const std::size_t bytes = out->pixels.size();
  if (bytes > most_kept_) return out;
  if (kept_bytes_ + bytes > most_kept_) {
    kept_.clear();
    kept_bytes_ = 0;
  }
  kept_.emplace(texture.image_number, out);
  kept_bytes_ += bytes;
  return out;
}

DecodedImages ImageDecoder::decode(bool strict, SlotTextures& textures) {
  DecodedImages out;
  for (std::size_t p = 0; p < textures.size(); ++p) {
    if (!textures[p] || out.contains(textures[p]->image_number)) continue;
    const std::string where = pointer_to(asset_.primitives[p]);
    try {
      out.emplace(textures[p]->image_number, image(*textures[p], where));
    } catch (const Error& e) {
      if (strict && e.code() != ErrorCode::unsupported_format) throw;
      note_kept(report_, "a texture was not baked: " + e.message(), where);
      const std::size_t failed = textures[p]->image_number;
      for (auto& texture : textures) {
        if (texture && texture->image_number == failed) texture.reset();
      }
    }
  }
  return out;
}

std::vector<texture::TextureSource> sources_of(const SlotTextures& textures, const DecodedImages& images) {
  std::vector<texture::TextureSource> out(textures.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (!textures[p]) continue;
    out[p].image = images.at(textures[p]->image_number).get();
    out[p].wrap_u = static_cast<texture::Wrap>(textures[p]->wrap_s);
    out[p].wrap_v = static_cast<texture::Wrap>(textures[p]->wrap_t);
    out[p].nearest = textures[p]->nearest;
    out[p].transform = textures[p]->transform;
  }
  return out;
}

std::vector<bool> bakes_vertex_colors(const asset::Asset& asset, const Delivery& delivery) {
  std::vector<bool> out(asset.primitives.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    const asset::Primitive& primitive = asset.primitives[p];
    const asset::Attribute* color = primitive.find("COLOR_0");
    out[p] = !delivery.primitives[p].indices.empty() && color != nullptr && color->components >= 3 &&
             !all_white(*color) && !morphs_color(primitive) && !asset::has_variants(asset, primitive);
  }
  return out;
}

} // namespace orbis
