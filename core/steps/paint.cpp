#include "core/steps/paint.h"

#include <algorithm>

#include "core/asset/image_codec.h"
#include "core/check_options.h"
#include "core/texture/bake.h"

namespace orbis {

using texture::Image;

bool may_show_own_colors(const Options& options) {
  return options.texture == TextureSource::automatic || options.texture == TextureSource::base_color;
}

std::string source_name(const Options& options, bool has_own_colors) {
  if (options.texture == TextureSource::cubemap) return "cubemap";
  if (has_own_colors) return "base_color";
  if (options.texture == TextureSource::base_color) {
    throw Error(ErrorCode::invalid_option,
                "texture=base_color needs a model with vertex colours, or with a base colour texture whose image comes "
                "with the request; use texture=auto or texture=pattern",
                "texture");
  }
  return "pattern";
}

std::vector<Image> uploaded_images(const Request& request, const Limits& limits) {
  std::vector<Image> images;
  if (request.options.texture != TextureSource::cubemap) return images;
  for (const std::string_view name : cube_map_files(request.file_names()))
    images.push_back(asset::decode_image(request.files.find(name)->second, limits.max_image_pixels, name));
  return images;
}

void check_texture(const Request& request, const asset::Asset& asset, const Limits& limits) {
  // They are read once more when they are baked: kept until then, they would take memory from the unfolding.
  (void)uploaded_images(request, limits);
  (void)source_name(request.options, std::ranges::any_of(asset.primitives, [&](const asset::Primitive& p) {
                      return p.find("COLOR_0") != nullptr ||
                             asset::material_texture(asset, p, asset::TextureSlot::base_color).has_value();
                    }));
}

Image paint(std::span<const Image> uploaded, const texture::TexelMap& map, const texture::CutMesh& cut,
            std::uint32_t page, const Progress& progress, mesh::ThreadPool& pool) {
  return uploaded.empty() ? texture::bake_pattern(map, cut, page, progress, pool)
                          : texture::bake_cube_map(map, cut, uploaded, progress, pool);
}

} // namespace orbis
