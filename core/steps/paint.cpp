#include "core/steps/paint.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/asset/image_codec.h"
#include "core/texture/bake.h"
#include "core/texture/preview.h"

namespace orbis {
namespace {

using texture::Image;

constexpr std::array<std::string_view, 6> cube_names{"px", "nx", "py", "ny", "pz", "nz"};
constexpr std::string_view equirectangular_name = "equirectangular";
constexpr std::uint32_t preview_width = 1600, preview_height = 800;

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

// The six images, or the one, that texture=cubemap takes.
std::vector<Image> uploaded_images(const Request& request, const Limits& limits) {
  std::vector<Image> images;
  if (find_file(request, equirectangular_name) != nullptr) {
    images.push_back(decode_file(request, equirectangular_name, limits));
  } else {
    for (const std::string_view name : cube_names) images.push_back(decode_file(request, name, limits));
  }
  return images;
}

// The base colour of every primitive, decoded.
struct OwnColors {
  std::vector<std::optional<asset::BaseColor>> colors; // by primitive
  std::vector<Image> images;                           // by primitive; empty where it has none
};

std::string pointer_to(const asset::Primitive& p) {
  return "/meshes/" + std::to_string(p.mesh) + "/primitives/" + std::to_string(p.primitive);
}

// An image in a format that orbis cannot decode is a note with texture=auto and an error with texture=base_color.
OwnColors own_colors(const asset::Asset& asset, const Limits& limits, bool required, Report& report) {
  OwnColors out;
  out.images.resize(asset.primitives.size());
  for (std::size_t p = 0; p < asset.primitives.size(); ++p) {
    out.colors.push_back(asset::base_color(asset, asset.primitives[p]));
    if (!out.colors[p]) continue;
    const std::string where = pointer_to(asset.primitives[p]);
    try {
      out.images[p] = asset::decode_image(out.colors[p]->image, limits.max_image_pixels, where);
    } catch (const Error& e) {
      if (required || e.code() != ErrorCode::unsupported_format) throw;
      out.colors[p].reset();
      report.notes.push_back(
          {"base-color-not-decodable", "the base colour image was not re-sampled: " + e.message(), where});
    }
  }
  return out;
}

bool has_any(const OwnColors& own) {
  return std::ranges::any_of(own.colors, [](const auto& color) { return color.has_value(); });
}

std::vector<Vec2f> source_uv(const asset::Asset& asset, const OwnColors& own, const Delivery& delivery) {
  std::vector<Vec2f> uv(delivery.of_cut_vertex.size());
  std::vector<const asset::Attribute*> attributes;
  for (std::size_t p = 0; p < asset.primitives.size(); ++p) {
    attributes.push_back(own.colors[p] ? asset.primitives[p].find(own.colors[p]->uv) : nullptr);
  }
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    const asset::Attribute* attribute = attributes[o.primitive];
    if (attribute == nullptr) continue;
    const VertexSource& source = delivery.sources[o.primitive][o.vertex];
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x += source.weights[k] * attribute->get(source.corners[k], 0);
      y += source.weights[k] * attribute->get(source.corners[k], 1);
    }
    uv[v] = {static_cast<float>(x), static_cast<float>(y)};
  }
  return uv;
}

std::vector<texture::BaseColorSource> sources_of(const asset::Asset& asset, const OwnColors& own) {
  std::vector<texture::BaseColorSource> sources(asset.primitives.size());
  for (std::size_t p = 0; p < sources.size(); ++p) {
    // Without an image: white, since the material keeps its base colour factor.
    if (!own.colors[p]) continue;
    sources[p].image = &own.images[p];
    sources[p].wrap_u = static_cast<texture::Wrap>(own.colors[p]->wrap_s);
    sources[p].wrap_v = static_cast<texture::Wrap>(own.colors[p]->wrap_t);
    std::ranges::copy(own.colors[p]->transform, sources[p].transform.begin());
  }
  return sources;
}

// One image a page.
template <class Bake> std::vector<Image> bake_pages(const texture::CutMesh& cut, Bake bake) {
  std::vector<Image> pages;
  for (std::uint32_t page = 0; page < cut.pages.size(); ++page) pages.push_back(bake(page));
  return pages;
}

} // namespace

std::vector<Image> paint(const Request& request, const Limits& limits, const asset::Asset& asset,
                         const Surface& surface, const texture::CutMesh& cut, const Delivery& delivery,
                         Progress& progress, Report& report) {
  const TextureSource wanted = request.options.texture;
  if (wanted == TextureSource::cubemap) {
    report.atlas.source = "cubemap";
    const std::vector<Image> images = uploaded_images(request, limits);
    return bake_pages(cut, [&](std::uint32_t page) { return texture::bake_cube_map(cut, page, images, progress); });
  }
  if (wanted != TextureSource::pattern) {
    const OwnColors own = own_colors(asset, limits, wanted == TextureSource::base_color, report);
    if (has_any(own)) {
      report.atlas.source = "base_color";
      const std::vector<Vec2f> uv = source_uv(asset, own, delivery);
      const std::vector<texture::BaseColorSource> sources = sources_of(asset, own);
      return bake_pages(cut, [&](std::uint32_t page) {
        return texture::bake_base_color(cut, page, uv, surface.primitive_of, sources, progress);
      });
    }
    if (wanted == TextureSource::base_color) {
      throw Error(ErrorCode::invalid_option,
                  "texture=base_color needs a model with a base colour texture whose image comes with the request; use "
                  "texture=auto or texture=pattern",
                  "texture");
    }
  }
  report.atlas.source = "pattern";
  return bake_pages(cut, [&](std::uint32_t page) { return texture::bake_pattern(cut, page, progress); });
}

std::vector<asset::NewImage> encode_atlas(std::span<const Image> pages, const std::vector<std::byte>& first_png,
                                          const Options& options) {
  std::vector<asset::NewImage> out;
  for (const Image& page : pages) {
    if (options.texture_format == TextureFormat::jpeg) {
      out.push_back({asset::encode_jpeg(page, static_cast<int>(options.jpeg_quality)), "image/jpeg"});
    } else {
      out.push_back({out.empty() ? first_png : asset::encode_png(page), "image/png"});
    }
  }
  return out;
}

std::vector<std::byte> preview(const Surface& surface, const texture::CutMesh& cut, std::span<const Image> pages) {
  return asset::encode_png(texture::draw_side_by_side(surface.mesh, cut, pages, preview_width, preview_height));
}

} // namespace orbis
