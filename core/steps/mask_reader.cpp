#include "core/steps/mask_reader.h"

#include <algorithm>

#include "core/asset/image_codec.h"
#include "core/asset/materials.h"

namespace orbis {
namespace {

// Occlusion is smooth: it tells no finer texels.
constexpr std::uint32_t largest_side = 1024;

} // namespace

MaskReader::MaskReader(const asset::Asset& asset, const Surface& surface, const Limits& limits)
    : asset_(asset), surface_(surface), limits_(limits), primitives_(asset.primitives.size()) {}

texture::AlphaMask MaskReader::operator()(std::uint32_t triangle) {
  const std::uint32_t p = surface_.primitive_of[triangle];
  const OfPrimitive& of = of_primitive(p);
  texture::AlphaMask out;
  out.cutoff = of.cutoff;
  if (of.texture != nullptr) out.texture = &of.texture->sampler;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = surface_.corners[triangle][k] - surface_.first_vertex[p];
    out.alpha[k] = of.factor;
    if (of.color != nullptr) out.alpha[k] *= static_cast<float>(of.color->get(v, 3));
    if (of.texture == nullptr) continue;
    const auto& m = of.to_texels;
    const double x = of.uv->get(v, 0), y = of.uv->get(v, 1);
    out.texels[k] = {double{m[0]} * x + double{m[1]} * y + double{m[2]},
                     double{m[3]} * x + double{m[4]} * y + double{m[5]}};
  }
  return out;
}

const MaskReader::OfPrimitive& MaskReader::of_primitive(std::uint32_t p) {
  OfPrimitive& out = primitives_[p];
  if (out.is_known) return out;
  out.is_known = true;
  const asset::Primitive& primitive = asset_.primitives[p];
  out.factor = asset::base_color_factor(asset_, primitive)[3];
  out.cutoff = asset::alpha_of(asset_, primitive).cutoff;
  out.color = primitive.find("COLOR_0");
  if (out.color != nullptr && out.color->components < 4) out.color = nullptr;
  const auto texture = asset::material_texture(asset_, primitive, asset::TextureSlot::base_color);
  if (texture) out.texture = texture_of(*texture);
  if (out.texture == nullptr) return out;
  out.uv = primitive.find(texture->uv);
  const texture::Image& image = out.texture->image;
  for (std::size_t i = 0; i < 6; ++i)
    out.to_texels[i] = texture->transform[i] * static_cast<float>(i < 3 ? image.width : image.height);
  return out;
}

const MaskTexture* MaskReader::texture_of(const asset::MaterialTexture& texture) {
  const std::tuple key{texture.image_number, texture.wrap_s, texture.wrap_t};
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const MaskTexture*& out = known_[key];
  try {
    texture::Image image = asset::decode_image(texture.image, limits_.max_image_pixels, {});
    while (std::max(image.width, image.height) > largest_side) image = texture::halved(image);
    out = &textures_.emplace_back(std::move(image), static_cast<texture::Wrap>(texture.wrap_s),
                                  static_cast<texture::Wrap>(texture.wrap_t));
  } catch (const Error&) {
    // The map of the base colour has noted it.
  }
  return out;
}

} // namespace orbis
