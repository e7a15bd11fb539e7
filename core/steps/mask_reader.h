// The alpha of the input's masks, triangle by triangle.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/asset/asset.h"
#include "core/options.h"
#include "core/steps/surface.h"
#include "core/texture/image.h"
#include "core/texture/occluders.h"
#include "core/texture/sampler.h"

namespace orbis {

// An image with what reads it. To be left where it is.
struct MaskTexture {
  texture::Image image;
  texture::Sampler sampler;

  MaskTexture(texture::Image image_, texture::Wrap wrap_u, texture::Wrap wrap_v)
      : image(std::move(image_)), sampler(image, wrap_u, wrap_v, 1) {}
  MaskTexture(const MaskTexture&) = delete; // the sampler refers to the image
  MaskTexture& operator=(const MaskTexture&) = delete;
};

// Base colour textures, vertex colours and factors of materials whose alphaMode is MASK.
class MaskReader {
public:
  // Keeps references to all of them.
  MaskReader(const asset::Asset& asset, const Surface& surface, const Limits& limits);

  // The mask of a triangle of the surface, no cap, whose material is one. Refers to a texture of this reader's. An
  // image that cannot be read leaves out nothing.
  [[nodiscard]] texture::AlphaMask operator()(std::uint32_t triangle);

  // What the masks refer to.
  [[nodiscard]] std::list<MaskTexture> take_textures() { return std::move(textures_); }

private:
  // What is the same in all triangles of a primitive.
  struct OfPrimitive {
    bool is_known = false;
    const asset::Attribute *uv = nullptr, *color = nullptr; // null: none
    const MaskTexture* texture = nullptr;                   // null: none
    std::array<float, 6> to_texels{};                       // row-major 2 x 3
    float factor = 1, cutoff = 0.5F;
  };

  const OfPrimitive& of_primitive(std::uint32_t p);
  const MaskTexture* texture_of(const asset::MaterialTexture& texture);

  const asset::Asset& asset_;
  const Surface& surface_;
  const Limits& limits_;
  std::vector<OfPrimitive> primitives_;
  std::list<MaskTexture> textures_;
  std::map<std::tuple<std::size_t, int, int>, const MaskTexture*> known_; // by image and wrap modes
};

} // namespace orbis
