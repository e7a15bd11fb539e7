#include "core/steps/paint.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/asset/image_codec.h"
#include "core/steps/placement.h"
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

Image paint_cube_map(const Request& request, const Limits& limits, const texture::AtlasLayout& layout,
                     Progress& progress) {
  std::vector<Image> images;
  if (find_file(request, equirectangular_name) != nullptr) {
    images.push_back(decode_file(request, equirectangular_name, limits));
  } else {
    for (const std::string_view name : cube_names) images.push_back(decode_file(request, name, limits));
  }
  return texture::bake_cube_map(layout, images, progress);
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

Image paint_own_colors(const asset::Asset& asset, const OwnColors& own, const Surface& surface,
                       const texture::CutMesh& cut, const Delivery& delivery, const texture::AtlasLayout& layout,
                       Progress& progress) {
  std::vector<texture::BaseColorSource> sources(asset.primitives.size());
  for (std::size_t p = 0; p < sources.size(); ++p) {
    // Without an image: white, since the material keeps its base colour factor.
    if (!own.colors[p]) continue;
    sources[p].image = &own.images[p];
    sources[p].wrap_u = static_cast<texture::Wrap>(own.colors[p]->wrap_s);
    sources[p].wrap_v = static_cast<texture::Wrap>(own.colors[p]->wrap_t);
    std::ranges::copy(own.colors[p]->transform, sources[p].transform.begin());
  }
  return texture::bake_base_color(layout, cut, source_uv(asset, own, delivery), surface.primitive_of, sources,
                                  progress);
}

// Faces that hold a part of a component.
std::uint64_t charts_in(const Surface& surface, const texture::CutMesh& cut) {
  std::uint64_t charts = 0;
  std::size_t t = 0;
  for (const Component& c : surface.components) {
    std::array<bool, texture::face_count> used{};
    for (; t < cut.parent.size() && cut.parent[t] < c.end_triangle(); ++t) used[cut.face[t]] = true;
    charts += static_cast<std::uint64_t>(std::ranges::count(used, true));
  }
  return charts;
}

// The same picture in each cell of the grid.
Image tiled(const Image& tile, const texture::AtlasLayout& layout, std::size_t side) {
  if (side == 1) return tile;
  Image out{layout.width, layout.height, tile.channels, {}};
  out.pixels.resize(std::size_t{out.width} * out.height * out.channels);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const auto u = static_cast<std::uint32_t>(std::uint64_t{x} * side % out.width * tile.width / out.width);
      const auto v = static_cast<std::uint32_t>(std::uint64_t{y} * side % out.height * tile.height / out.height);
      std::copy_n(tile.at(u, v), tile.channels, out.pixels.data() + (std::size_t{y} * out.width + x) * out.channels);
    }
  }
  return out;
}

} // namespace

Image paint(const Request& request, const Limits& limits, const asset::Asset& asset, const Surface& surface,
            const texture::CutMesh& cut, const Delivery& delivery, const texture::AtlasLayout& layout,
            Progress& progress, Report& report) {
  report.atlas.width = layout.width;
  report.atlas.height = layout.height;
  report.atlas.gutter = layout.gutter;
  report.atlas.utilisation = layout.utilisation();
  report.atlas.charts = charts_in(surface, cut);
  report.atlas.cut_triangles = cut.cut_triangles;
  report.atlas.added_vertices = cut.points - surface.mesh.positions.size();

  const std::size_t side = cells_for(surface.components.size()).side;
  const texture::AtlasLayout cell = texture::layout_for(std::max(64U, layout.width / static_cast<std::uint32_t>(side)));
  const TextureSource wanted = request.options.texture;
  if (wanted == TextureSource::cubemap) {
    report.atlas.source = "cubemap";
    return tiled(paint_cube_map(request, limits, cell, progress), layout, side);
  }
  if (wanted != TextureSource::pattern) {
    const OwnColors own = own_colors(asset, limits, wanted == TextureSource::base_color, report);
    if (has_any(own)) {
      report.atlas.source = "base_color";
      return paint_own_colors(asset, own, surface, cut, delivery, layout, progress);
    }
    if (wanted == TextureSource::base_color) {
      throw Error(ErrorCode::invalid_option,
                  "texture=base_color needs a model with a base colour texture whose image comes with the request; use "
                  "texture=auto or texture=pattern",
                  "texture");
    }
  }
  report.atlas.source = "pattern";
  return tiled(texture::bake_pattern(cell, progress), layout, side);
}

asset::NewImage encode_atlas(const Image& atlas, const std::vector<std::byte>& png, const Options& options) {
  if (options.texture_format == TextureFormat::png) return {png, "image/png"};
  return {asset::encode_jpeg(atlas, static_cast<int>(options.jpeg_quality)), "image/jpeg"};
}

std::vector<std::byte> preview(const Surface& surface, const texture::CutMesh& cut, const Image& atlas) {
  return asset::encode_png(texture::draw_side_by_side(surface.mesh, cut, atlas, preview_width, preview_height));
}

} // namespace orbis
