#include "core/steps/bake_maps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/asset/image_codec.h"
#include "core/steps/corner_values.h"
#include "core/steps/encode_map.h"
#include "core/steps/material_sources.h"
#include "core/steps/occlusion_trees.h"
#include "core/steps/paint.h"
#include "core/steps/shared_frames.h"
#include "core/steps/tangent_frames.h"
#include "core/texture/bake_maps.h"
#include "core/texture/bake_occlusion.h"

namespace orbis {
namespace {

using asset::TextureSlot;
using texture::Encoding;
using texture::Image;

bool any(const SlotTextures& textures) {
  return std::ranges::any_of(textures, [](const auto& t) { return t.has_value(); });
}
bool any(const std::vector<bool>& flags) { return std::ranges::find(flags, true) != flags.end(); }

bool read_alike(const std::optional<asset::MaterialTexture>& a, const std::optional<asset::MaterialTexture>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->image_number == b->image_number && a->uv == b->uv && a->wrap_s == b->wrap_s && a->wrap_t == b->wrap_t &&
         a->nearest == b->nearest && a->transform == b->transform;
}

bool has_alpha(const std::vector<texture::TextureSource>& sources) {
  return std::ranges::any_of(sources, [](const auto& s) { return s.image != nullptr && s.image->channels == 4; });
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

texture::Box box_of(const std::vector<Vec3f>& positions) {
  texture::Box box{Vec3d(positions.front()), Vec3d(positions.front())};
  for (const Vec3f& p : positions) {
    box.low = {std::min(box.low.x, double{p.x}), std::min(box.low.y, double{p.y}), std::min(box.low.z, double{p.z})};
    box.high = {std::max(box.high.x, double{p.x}), std::max(box.high.y, double{p.y}),
                std::max(box.high.z, double{p.z})};
  }
  return box;
}

std::vector<Vec2f> uv_of(const texture::CutMesh& cut) {
  std::vector<Vec2f> out;
  out.reserve(cut.vertices.size());
  for (const texture::CutVertex& v : cut.vertices) out.push_back(v.uv);
  return out;
}

// For parts of a stage that would report on themselves.
class OnlyCancellation final : public Progress {
public:
  explicit OnlyCancellation(const Progress& whole) : whole_(whole) {}
  void report(Stage, std::uint64_t, std::uint64_t) override {}
  [[nodiscard]] bool cancelled() const override { return whole_.cancelled(); }

private:
  const Progress& whole_;
};

class Baker {
public:
  Baker(const Request& request, const Limits& limits, const SurfaceInAtlas& from, const SurfaceInAtlas& shown,
        Delivery& delivery, std::span<DetailLevel> levels, Progress& progress, Report& report)
      : request_(request), limits_(limits), asset_(from.asset), surface_(from.surface), cut_(from.cut), shown_(shown),
        delivery_(delivery), levels_(levels), progress_(progress), report_(report), pool_(request.options.threads),
        values_(from.asset, from.surface, from.cut, pool_), uv_(uv_of(cut_)) {
    for (std::size_t t = 0; t < cut_.triangles.size(); ++t) primitive_of_.push_back(values_.primitive(t));
  }

  BakedMaps run() {
    plan();
    for (page_ = 0; page_ < cut_.pages.size(); ++page_) {
      step(0);
      values_.show(triangles_on_page(cut_));
      const texture::Page& size = cut_.pages[page_];
      map_.emplace(page_mesh(), size.width, size.height, pool_);
      bake_base_color();
      step(1);
      bake_metallic_roughness_and_occlusion();
      step(2);
      bake_emissive();
      step(3);
      bake_normals();
      step(4);
      bake_ambient_occlusion();
      step(5);
      bake_positions();
    }
    page_ = static_cast<std::uint32_t>(cut_.pages.size() - 1);
    step(parts_a_page);
    return std::move(out_);
  }

private:
  static constexpr std::uint64_t parts_a_page = 6;

  void step(std::uint64_t part) {
    progress_.check();
    progress_.report(Stage::bake, page_ * parts_a_page + part, cut_.pages.size() * parts_a_page);
  }

  [[nodiscard]] bool wants(Map map) const { return options().maps.automatic || options().maps.names(map); }
  [[nodiscard]] const Options& options() const { return request_.options; }
  [[nodiscard]] texture::PageMesh page_mesh() const { return {uv_, cut_.triangles, values_.shown()}; }
  [[nodiscard]] bool on_page(std::size_t primitive) const {
    return !delivery_.primitives[primitive].indices.empty() && delivery_.page_of[primitive] == page_;
  }
  [[nodiscard]] std::vector<std::uint32_t> triangles_on_page(const texture::CutMesh& cut) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t t = 0; t < cut.triangles.size(); ++t) {
      if (cut.page_of(t) == page_) out.push_back(t);
    }
    return out;
  }
  [[nodiscard]] SlotTextures on_page(const SlotTextures& textures) const {
    SlotTextures out(textures.size());
    for (std::size_t p = 0; p < out.size(); ++p) {
      if (on_page(p)) out[p] = textures[p];
    }
    return out;
  }

  // --- What is there to bake from -----------------------------------------------------------------------------------

  void plan() {
    base_color_ = SlotTextures(asset_.primitives.size());
    colored_ = std::vector<bool>(asset_.primitives.size());
    if (may_show_own_colors(options())) {
      base_color_ = textures_of(asset_, delivery_, TextureSlot::base_color, report_);
      colored_ = bakes_vertex_colors(asset_, delivery_);
    }
    shows_own_ = any(base_color_) || any(colored_);
    report_.atlas.source = source_name(options(), shows_own_);
    uploaded_ = uploaded_images(request_, limits_);
    metallic_roughness_ = planned(Map::metallic_roughness, TextureSlot::metallic_roughness);
    occlusion_ = planned(Map::occlusion, TextureSlot::occlusion);
    emissive_ = planned(Map::emissive, TextureSlot::emissive);
    if (wants(Map::normal) || options().maps.names(Map::object_normal)) {
      normal_ = textures_of(asset_, delivery_, TextureSlot::normal, report_);
    }
  }

  // The textures of a slot if the map is wanted; a map that was asked for by name and has nothing to show is noted.
  SlotTextures planned(Map map, TextureSlot slot) {
    if (!wants(map)) return SlotTextures(asset_.primitives.size());
    SlotTextures textures = textures_of(asset_, delivery_, slot, report_);
    if (!any(textures) && options().maps.names(map)) {
      report_.notes.push_back(
          {"map-not-baked", "no material has a texture that the map could be baked from", std::string(name_of(map))});
    }
    return textures;
  }

  // --- Colours and data ---------------------------------------------------------------------------------------------

  void bake_base_color() {
    SlotTextures textures = on_page(base_color_);
    const DecodedImages images =
        decode(asset_, limits_, options().texture == TextureSource::base_color, textures, report_);
    std::vector<bool> takes(textures.size());
    for (std::size_t p = 0; p < takes.size(); ++p) {
      takes[p] = on_page(p) && (!shows_own_ || textures[p].has_value() || colored_[p]);
    }
    Image image = shows_own_ ? resample(textures, images, colored_, Encoding::srgb) : painted();
    if (wants(Map::base_color) && any(takes)) {
      const std::uint32_t number = add_image(image, MapKind::color, "base_color");
      for (std::size_t p = 0; p < takes.size(); ++p) {
        if (!takes[p]) continue;
        delivery_.primitives[p].textures[TextureSlot::base_color] = number;
        delivery_.primitives[p].plain_base_color = !shows_own_;
        if (shows_own_ && !colored_[p]) continue;
        set_colors_aside(delivery_.primitives[p]);
        for (DetailLevel& level : levels_) set_colors_aside(level.delivery.primitives[p]);
      }
    }
    out_.pages.push_back(std::move(image));
  }

  Image painted() {
    OnlyCancellation part(progress_);
    return paint(uploaded_, shown_.cut, page_, part);
  }

  // Occlusion is stored in red, roughness in green, metalness in blue: one image for both where both are there.
  void bake_metallic_roughness_and_occlusion() {
    SlotTextures metals = on_page(metallic_roughness_), occlusion = on_page(occlusion_);
    const bool alike = std::ranges::equal(metals, occlusion, read_alike);
    const DecodedImages metals_images = decode(asset_, limits_, false, metals, report_);
    if (alike) occlusion = metals;
    const DecodedImages occlusion_images = alike ? DecodedImages{} : decode(asset_, limits_, false, occlusion, report_);
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
    const std::uint32_t number = add_image(image, MapKind::data, name);
    show(metals, TextureSlot::metallic_roughness, number);
    show(occlusion, TextureSlot::occlusion, number);
  }

  void bake_emissive() {
    SlotTextures textures = on_page(emissive_);
    const DecodedImages images = decode(asset_, limits_, false, textures, report_);
    if (!any(textures)) return;
    show(textures, TextureSlot::emissive,
         add_image(resample(textures, images, {}, Encoding::srgb), MapKind::color, "emissive"));
  }

  void show(const SlotTextures& textures, TextureSlot slot, std::uint32_t number) {
    for (std::size_t p = 0; p < textures.size(); ++p) {
      if (textures[p]) delivery_.primitives[p].textures[slot] = number;
    }
  }

  Image resample(const SlotTextures& textures, const DecodedImages& images, const std::vector<bool>& colored,
                 Encoding encoding) {
    const std::vector<texture::CornerUv> uv = source_uv(textures);
    const std::vector<texture::TextureSource> sources = sources_of(textures, images);
    const texture::TextureReader reader(*map_, values_.shown(), uv, primitive_of_, sources, encoding);
    std::vector<texture::CornerColor> colors;
    if (any(colored)) colors = values_.colors(colored);
    const bool alpha = encoding == Encoding::srgb && has_alpha(sources);
    return texture::bake_texture(*map_, reader, colors, encoding, alpha, pool_);
  }

  [[nodiscard]] std::vector<texture::CornerUv> source_uv(const SlotTextures& textures) const {
    std::vector<const asset::Attribute*> uv_of(textures.size());
    for (std::size_t p = 0; p < textures.size(); ++p) {
      if (textures[p]) uv_of[p] = asset_.primitives[p].find(textures[p]->uv);
    }
    return values_.uv(uv_of);
  }

  // --- Geometry -----------------------------------------------------------------------------------------------------

  void bake_normals() {
    const bool objects = options().maps.names(Map::object_normal);
    if (!wants(Map::normal) && !objects) return;
    SlotTextures textures = on_page(normal_);
    const DecodedImages images = decode(asset_, limits_, false, textures, report_);
    const std::vector<bool> wanted = takes_normal_map(textures);
    if (!any(wanted) && !objects) return;

    const std::vector<std::array<Vec3f, 3>> normals = values_.normals();
    const std::vector<texture::CornerUv> uv = source_uv(textures);
    const std::vector<texture::TextureSource> sources = sources_of(textures, images);
    const texture::TextureReader reader(*map_, values_.shown(), uv, primitive_of_, sources, Encoding::linear);
    std::vector<std::array<texture::Tangent, 3>> old_frames;
    if (any(textures)) old_frames = values_.tangents(normal_uv(textures));
    std::vector<float> scales(textures.size());
    for (std::size_t p = 0; p < scales.size(); ++p) scales[p] = textures[p] ? textures[p]->scale : 0;
    const texture::NormalSource source{normals, old_frames, any(textures) ? &reader : nullptr, scales, primitive_of_};

    if (objects) add_normals("object_normal", texture::bake_normals(*map_, source, nullptr, pool_), false);
    if (!any(wanted)) return;
    const TangentFrames frames =
        add_tangent_frames(shown_.asset, shown_.surface, shown_.cut, wanted, delivery_, report_);
    const std::uint32_t number = add_normals("normal", bake_normals_in(frames, source), true);
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      if (wanted[p]) delivery_.primitives[p].textures[TextureSlot::normal] = number;
    }
    if (!levels_.empty()) bake_normals_of_levels(source, wanted);
  }

  // In the frames of what is delivered, wherever the normals come from.
  texture::Image16 bake_normals_in(const TangentFrames& frames, const texture::NormalSource& source) {
    std::optional<texture::TexelMap> own; // of the delivered triangles, where the page's are others
    const std::vector<Vec2f> uv = uv_of(shown_.cut);
    const std::vector<std::uint32_t> on_page = triangles_on_page(shown_.cut);
    if (&shown_.cut != &cut_) {
      own.emplace(texture::PageMesh{uv, shown_.cut.triangles, on_page}, map_->width(), map_->height(), pool_);
    }
    const texture::FrameField field{own ? &*own : &*map_, shown_.cut.triangles, frames.normals, frames.tangents};
    return texture::bake_normals(*map_, source, &field, pool_);
  }

  // One map for all levels, in the frames of the coarsest. Of a primitive that has nothing left there, each level has
  // frames of its own under the full surface's map.
  void bake_normals_of_levels(const texture::NormalSource& source, const std::vector<bool>& wanted) {
    DetailLevel& coarsest = levels_.back();
    std::vector<bool> shared = wanted, apart = wanted;
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      shared[p] = wanted[p] && !coarsest.delivery.primitives[p].indices.empty();
      apart[p] = wanted[p] && !shared[p];
    }
    Report already_noted; // of the full surface
    for (DetailLevel& level : levels_) {
      add_tangent_frames(shown_.asset, shown_.surface, level.level.mesh, apart, level.delivery, already_noted);
    }
    if (!any(shared)) return;
    const SharedFrames frames(shown_.asset, shown_.surface, shown_.cut, page_, shared, coarsest, *map_, pool_);
    for (DetailLevel& level : levels_.first(levels_.size() - 1)) {
      frames.give_to(shown_.asset, shown_.surface, level.level.mesh, level.delivery);
    }
    const texture::FrameField field = frames.field();
    const std::uint32_t number = add_normals("normal_lods", texture::bake_normals(*map_, source, &field, pool_), true);
    for (DetailLevel& level : levels_) {
      for (std::size_t p = 0; p < shared.size(); ++p) {
        if (shared[p]) level.delivery.primitives[p].textures[TextureSlot::normal] = number;
      }
    }
  }

  // The primitives whose normal map is baked: with maps=auto those that have one, by name all. Not where other textures
  // depend on the TANGENT that would change.
  std::vector<bool> takes_normal_map(const SlotTextures& textures) {
    std::vector<bool> out(textures.size());
    for (std::size_t p = 0; p < out.size(); ++p) {
      const bool named = options().maps.names(Map::normal);
      if (!on_page(p) || !(named || (options().maps.automatic && textures[p]))) continue;
      out[p] = !asset::shares_tangents(asset_, asset_.primitives[p]);
      if (out[p]) continue;
      report_.notes.push_back({"normal-map-kept",
                               "the normal map was not baked: the clear coat, the anisotropy or a variant's material "
                               "needs the tangents that it would change",
                               pointer_to(asset_.primitives[p])});
    }
    return out;
  }

  [[nodiscard]] std::vector<CornerValues::NormalUv> normal_uv(const SlotTextures& textures) const {
    std::vector<CornerValues::NormalUv> out(textures.size());
    for (std::size_t p = 0; p < out.size(); ++p) {
      if (textures[p]) out[p] = {asset_.primitives[p].find(textures[p]->uv), textures[p]->transform};
    }
    return out;
  }

  std::uint32_t add_normals(const std::string& name, const texture::Image16& image, bool shown) {
    if (options().normal_bits == 16)
      return add(encode_map(image, named(name), options()), image.width, image.height, 16, shown);
    const Image rounded = texture::to_8_bits(image);
    return add(encode_map(rounded, MapKind::directions, named(name), options()), image.width, image.height, 8, shown);
  }

  // In as many texels as the bound on the rays allows.
  void bake_ambient_occlusion() {
    if (!options().maps.names(Map::ambient_occlusion)) return;
    constexpr double most_texels = 1U << 17U;
    const double texels = static_cast<double>(map_->width()) * map_->height() * static_cast<double>(cut_.pages.size());
    const auto step = static_cast<std::uint32_t>(std::max(std::ceil(std::sqrt(texels / most_texels)), 1.0));
    const texture::TexelMap map(page_mesh(), std::max(map_->width() / step, 1U), std::max(map_->height() / step, 1U),
                                pool_);
    if (!trees_) trees_ = occlusion_trees(surface_, cut_);
    const Image image = texture::bake_occlusion(map, values_.positions(), values_.normals(),
                                                {trees_->trees, trees_->tree_of}, trees_->offset, pool_);
    const std::uint32_t number = add_image(image, MapKind::data, "ambient_occlusion");
    for (std::size_t p = 0; p < asset_.primitives.size(); ++p) {
      if (!on_page(p) || asset::names_texture(asset_, asset_.primitives[p], TextureSlot::occlusion)) continue;
      delivery_.primitives[p].textures[TextureSlot::occlusion] = number;
    }
  }

  void bake_positions() {
    if (!options().maps.names(Map::position)) return;
    const texture::Box box = box_of(surface_.mesh.positions);
    const texture::Image16 image = texture::bake_positions(*map_, values_.positions(), box, pool_);
    add(encode_map(image, named("position"), options()), image.width, image.height, 16, false);
    report_.maps.back().range = {box.low, box.high - box.low};
  }

  // --- Results ------------------------------------------------------------------------------------------------------

  // "normal"; with several pages "normal-2".
  [[nodiscard]] std::string named(const std::string& map) const {
    return cut_.pages.size() > 1 ? map + '-' + std::to_string(page_ + 1) : map;
  }

  std::uint32_t add_image(const Image& image, MapKind kind, const std::string& name) {
    return add(encode_map(image, kind, named(name), options()), image.width, image.height, 8, true);
  }

  // Every map becomes a file; what materials show becomes an image of the result too, whose number is returned.
  std::uint32_t add(asset::NewImage image, std::uint32_t width, std::uint32_t height, std::uint32_t bits, bool shown) {
    const std::string file = image.name + "." + ending_of(image);
    report_.maps.push_back({file, page_, width, height, bits, image.bytes.size(), {}});
    out_.files.push_back({file, image.bytes});
    if (!shown) return 0;
    out_.images.push_back(std::move(image));
    return static_cast<std::uint32_t>(out_.images.size() - 1);
  }

  const Request& request_;
  const Limits& limits_;
  const asset::Asset& asset_;
  const Surface& surface_;
  const texture::CutMesh& cut_;
  SurfaceInAtlas shown_;
  Delivery& delivery_;
  std::span<DetailLevel> levels_;
  Progress& progress_;
  Report& report_;
  mesh::ThreadPool pool_;
  CornerValues values_;                     // of the page in work
  std::vector<std::uint32_t> primitive_of_; // by delivered triangle
  std::vector<Vec2f> uv_;                   // by cut vertex

  SlotTextures base_color_, metallic_roughness_, occlusion_, emissive_, normal_;
  std::vector<bool> colored_; // by primitive: its vertex colours are baked
  bool shows_own_ = false;    // the base colour is the model's own
  std::vector<Image> uploaded_;
  std::optional<OcclusionTrees> trees_;

  std::uint32_t page_ = 0;
  std::optional<texture::TexelMap> map_; // of the page in work
  BakedMaps out_;
};

} // namespace

std::vector<std::byte> atlas_picture(const BakedMaps& maps, const Options& options) {
  for (const MapFile& file : maps.files) {
    if (file.name == "base_color.png" || file.name == "base_color-1.png") return file.bytes;
  }
  return asset::encode_png(maps.pages.front(), Encoding::srgb, options.threads);
}

BakedMaps bake_maps(const Request& request, const Limits& limits, const SurfaceInAtlas& from,
                    const SurfaceInAtlas& shown, Delivery& delivery, std::span<DetailLevel> levels, Progress& progress,
                    Report& report) {
  return Baker(request, limits, from, shown, delivery, levels, progress, report).run();
}

} // namespace orbis
