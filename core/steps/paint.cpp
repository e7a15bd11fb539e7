#include "core/steps/paint.h"

#include <algorithm>
#include <array>

#include "core/asset/image_codec.h"
#include "core/texture/bake.h"

namespace orbis {
namespace {

using texture::Image;

constexpr std::array<std::string_view, 6> cube_names{"px", "nx", "py", "ny", "pz", "nz"};
constexpr std::string_view equirectangular_name = "equirectangular";

// The file whose name without its ending is `stem`, or nothing.
const std::vector<std::byte>* find_file(const Request& request, std::string_view stem) {
  for (const auto& [name, bytes] : request.files) {
    if (std::string_view(name).substr(0, name.rfind('.')) == stem) return &bytes;
  }
  return nullptr;
}

Image decode_file(const Request& request, std::string_view stem, const Limits& limits) {
  const std::vector<std::byte>* bytes = find_file(request, stem);
  if (bytes == nullptr) {
    throw Error(
        ErrorCode::missing_resource,
        "texture=cubemap takes six images named px, nx, py, ny, pz, nz, or one named equirectangular (any ending); '" +
            std::string(stem) + "' did not come with the request",
        "texture");
  }
  return asset::decode_image(*bytes, limits.max_image_pixels, stem);
}

} // namespace

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
  if (find_file(request, equirectangular_name) != nullptr) {
    images.push_back(decode_file(request, equirectangular_name, limits));
  } else {
    for (const std::string_view name : cube_names) images.push_back(decode_file(request, name, limits));
  }
  return images;
}

Image paint(std::span<const Image> uploaded, const texture::TexelMap& map, const texture::CutMesh& cut,
            std::uint32_t page, const Progress& progress, mesh::ThreadPool& pool) {
  return uploaded.empty() ? texture::bake_pattern(map, cut, page, progress, pool)
                          : texture::bake_cube_map(map, cut, uploaded, progress, pool);
}

} // namespace orbis
