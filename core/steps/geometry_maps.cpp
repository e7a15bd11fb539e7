#include "core/steps/geometry_maps.h"

#include <algorithm>
#include <cmath>

#include "core/asset/materials.h"
#include "core/steps/tangent_frames.h"
#include "core/texture/bake_displacement.h"
#include "core/texture/bake_occlusion.h"
#include "core/texture/smooth_frames.h"

namespace orbis {
namespace {

using asset::TextureSlot;
using texture::Encoding;
using texture::Image;

texture::Box box_of(const std::vector<Vec3f>& positions) {
  texture::Box box{Vec3d(positions.front()), Vec3d(positions.front())};
  for (const Vec3f& p : positions) {
    box.low = {std::min(box.low.x, double{p.x}), std::min(box.low.y, double{p.y}), std::min(box.low.z, double{p.z})};
    box.high = {std::max(box.high.x, double{p.x}), std::max(box.high.y, double{p.y}),
                std::max(box.high.z, double{p.z})};
  }
  return box;
}

std::vector<CornerValues::NormalUv> normal_uv(const asset::Asset& asset, const SlotTextures& textures) {
  std::vector<CornerValues::NormalUv> out(textures.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (textures[p]) out[p] = {asset.primitives[p].find(textures[p]->uv), textures[p]->transform};
  }
  return out;
}

} // namespace

GeometryMaps::GeometryMaps(const BakeJob& job, PageBaking& page)
    : job_(job), page_(page), frames_(job.shown.surface, job.shown.cut) {
  levels_.reserve(job.levels.size());
  for (const DetailLevel& level : job.levels) {
    const std::size_t vertices = level.level.mesh.vertices.size();
    levels_.push_back({MeshByPage(level.level.mesh), std::vector<Vec3f>(vertices), std::vector<Vec3f>(vertices)});
  }
  if (job.wants(Map::normal) || job.options().maps.names(Map::object_normal)) {
    normal_ = textures_of(job.asset, job.delivery, TextureSlot::normal, job.report);
  }
}

void GeometryMaps::bake_normals() {
  const bool objects = job_.options().maps.names(Map::object_normal);
  if (!job_.wants(Map::normal) && !objects) return;
  SlotTextures textures = page_.shown(normal_);
  const DecodedImages images = page_.images().decode(false, textures);
  const std::vector<bool> wanted = takes_normal_map(textures), of_levels = levels_take_normal_map(wanted);
  if (!any(wanted) && !any(of_levels) && !objects) return;

  CornerValues& values = page_.values();
  const std::span<const std::array<Vec3f, 3>> normals = values.normals();
  const std::span<const texture::CornerUv> uv = page_.source_uv(textures);
  const std::vector<texture::TextureSource> sources = sources_of(textures, images);
  const texture::TextureReader reader(page_.map(), values.shown(), uv, page_.primitive_of(), sources, Encoding::linear);
  std::span<const std::array<texture::Tangent, 3>> old_frames;
  if (any(textures)) old_frames = values.tangents(normal_uv(job_.asset, textures));
  std::vector<float> scales(textures.size());
  for (std::size_t p = 0; p < scales.size(); ++p) scales[p] = textures[p] ? textures[p]->scale : 0;
  const texture::NormalSource source{normals, old_frames, any(textures) ? &reader : nullptr, scales,
                                     page_.primitive_of()};

  if (objects) add_normals("object_normal", source, nullptr, false);
  if (any(wanted)) {
    const std::vector<std::uint32_t> triangles = delivered_triangles(wanted);
    const TangentFrames& frames = frames_.find(triangles, job_.delivery);
    deliver_frames(triangles, frames, wanted);
    const std::uint32_t number = add_normals("normal", source, frames);
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      if (wanted[p]) job_.delivery.primitives[p].textures[TextureSlot::normal] = number;
    }
  }
  if (any(of_levels)) bake_normals_of_levels(source, of_levels);
}

// Those on the page whose primitives are wanted.
std::vector<std::uint32_t> GeometryMaps::delivered_triangles(const std::vector<bool>& wanted) const {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t t : page_.delivered_map().shown())
    if (wanted[job_.shown.surface.primitive_of[job_.shown.cut.parent[t]]]) out.push_back(t);
  return out;
}

void GeometryMaps::deliver_frames(std::span<const std::uint32_t> triangles, const TangentFrames& frames,
                                  const std::vector<bool>& wanted) {
  const std::vector<FrameAttributes> attributes =
      add_frame_attributes(job_.shown.asset, wanted, job_.delivery, job_.report);
  for (const std::uint32_t t : triangles) {
    for (const mesh::Index v : job_.shown.cut.triangles[t]) {
      const OutputVertex o = job_.delivery.of_cut_vertex[v];
      const FrameAttributes& primitive = attributes[o.primitive];
      if (primitive.normal_is_new) {
        primitive.set(o.vertex, {frames.normals[v], frames.tangents[v]});
      } else {
        primitive.set_tangent(o.vertex, frames.tangents[v]);
      }
    }
  }
}

texture::FrameField GeometryMaps::field_of(const TangentFrames& frames) const {
  return {&page_.delivered_map(), job_.shown.cut.triangles, frames.normals, frames.tangents};
}

// The levels' vertices take the smooth frames.
void GeometryMaps::follow(const texture::SmoothFrames& smooth, const std::vector<bool>& wanted) {
  Report already_noted; // of the full surface
  for (std::size_t i = 0; i < job_.levels.size(); ++i) {
    const texture::CutMesh& mesh = job_.levels[i].level.mesh;
    Delivery& delivery = job_.levels[i].delivery;
    const std::vector<FrameAttributes> attributes =
        add_frame_attributes(job_.shown.asset, wanted, delivery, already_noted);
    for (const std::uint32_t t : levels_[i].by_page.triangles(page_.page())) {
      for (const mesh::Index v : mesh.triangles[t]) {
        const OutputVertex o = delivery.of_cut_vertex[v];
        if (wanted[o.primitive]) attributes[o.primitive].set(o.vertex, smooth.at(mesh.chart[t], mesh.vertices[v].uv));
      }
    }
  }
}

// One map for all levels, in frames that all of them can follow (smooth_frames.h).
void GeometryMaps::bake_normals_of_levels(const texture::NormalSource& source, const std::vector<bool>& wanted) {
  const texture::CutMesh& cut = job_.shown.cut;
  TangentFrames& frames = frames_.find(delivered_triangles(wanted), job_.delivery);
  const texture::SmoothFrames smooth(cut, page_.charts(), field_of(frames));
  follow(smooth, wanted);
  for (const std::uint32_t t : page_.delivered_map().shown()) {
    for (const mesh::Index v : cut.triangles[t]) {
      const texture::VertexFrame frame = smooth.at(cut.chart[t], cut.vertices[v].uv);
      frames.normals[v] = frame.normal;
      frames.tangents[v] = frame.tangent;
    }
  }
  const std::uint32_t number = add_normals("normal_lods", source, frames);
  for (DetailLevel& level : job_.levels) {
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      if (wanted[p]) level.delivery.primitives[p].textures[TextureSlot::normal] = number;
    }
  }
}

// The primitives whose normal map is baked: with maps=auto those that have one, and all of a remesh, whose triangles
// lie across the input's (a morph's second shape would show the first one's); by name all. Not where other textures
// depend on the TANGENT that would change.
std::vector<bool> GeometryMaps::takes_normal_map(const SlotTextures& textures) const {
  std::vector<bool> out(textures.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    const bool named = job_.options().maps.names(Map::normal);
    const bool is_remesh = job_.options().remesh.base != RemeshTarget::Base::none && job_.options().morph_to.empty();
    if (!page_.shows(p) || !(named || (job_.options().maps.automatic && (textures[p] || is_remesh)))) continue;
    out[p] = !asset::shares_tangents(job_.asset, job_.asset.primitives[p]);
    if (out[p]) continue;
    job_.report.notes.push_back({"normal-map-kept",
                                 "the normal map was not baked: the clear coat, the anisotropy or a variant's material "
                                 "needs the tangents that it would change",
                                 pointer_to(job_.asset.primitives[p])});
  }
  return out;
}

// Those, and with maps=auto every primitive: what a level has fewer triangles for is then in the map.
std::vector<bool> GeometryMaps::levels_take_normal_map(const std::vector<bool>& full) const {
  if (job_.levels.empty()) return std::vector<bool>(full.size());
  std::vector<bool> out = full;
  for (std::size_t p = 0; p < out.size() && job_.options().maps.automatic; ++p) {
    out[p] =
        out[p] || (page_.shows(p) && !asset::names_texture(job_.asset, job_.asset.primitives[p], TextureSlot::normal) &&
                   !asset::shares_tangents(job_.asset, job_.asset.primitives[p]));
  }
  return out;
}

std::uint32_t GeometryMaps::add_normals(const std::string& name, const texture::NormalSource& source,
                                        const TangentFrames& frames) {
  const texture::FrameField field = field_of(frames);
  return add_normals(name, source, &field, true);
}

std::uint32_t GeometryMaps::add_normals(const std::string& name, const texture::NormalSource& source,
                                        const texture::FrameField* frames, bool shown) {
  const auto bake = [&]<class Picture>() {
    return texture::bake_normals<Picture>(page_.map(), source, frames, job_.progress, page_.pool());
  };
  return job_.options().normal_bits == 16
             ? page_.add(bake.operator()<texture::Image16>(), MapKind::directions, name, shown)
             : page_.add(bake.operator()<Image>(), MapKind::directions, name, shown);
}

std::vector<bool> GeometryMaps::two_sided_triangles() const {
  std::vector<bool> primitives, out;
  primitives.reserve(job_.asset.primitives.size());
  for (const asset::Primitive& p : job_.asset.primitives) primitives.push_back(asset::is_double_sided(job_.asset, p));
  out.reserve(page_.primitive_of().size());
  for (const std::uint32_t p : page_.primitive_of()) out.push_back(primitives[p]);
  return out;
}

void GeometryMaps::bake_ambient_occlusion() {
  if (!job_.options().maps.names(Map::ambient_occlusion)) return;
  // Occlusion is smooth, and rays are dear: the map is coarser than the others, but never so coarse that charts would
  // come closer than the texels that are read together.
  constexpr double most_texels = 1U << 18U;
  const texture::TexelMap& whole = page_.map();
  const double texels =
      static_cast<double>(whole.width()) * whole.height() * static_cast<double>(job_.cut.pages.size());
  const auto wanted = static_cast<std::uint32_t>(std::max(std::ceil(std::sqrt(texels / most_texels)), 1.0));
  const std::uint32_t step = std::min(wanted, std::max(job_.cut.gutter, 1U));
  const texture::TexelMap map(page_.mesh(), std::max(whole.width() / step, 1U), std::max(whole.height() / step, 1U),
                              page_.pool());
  if (!trees_) trees_ = occlusion_trees(job_.asset, job_.surface, job_.cut, job_.limits, job_.report);
  if (!two_sided_) two_sided_ = two_sided_triangles();
  const Image image = texture::bake_occlusion(map, page_.values().positions(), page_.values().normals(),
                                              {trees_->trees, trees_->tree_of, trees_->component_of}, *two_sided_,
                                              trees_->offset, job_.progress, page_.pool());
  const std::uint32_t number = page_.add(image, MapKind::data, "ambient_occlusion");
  for (std::size_t p = 0; p < job_.asset.primitives.size(); ++p) {
    if (!page_.shows(p) || asset::names_texture(job_.asset, job_.asset.primitives[p], TextureSlot::occlusion)) continue;
    job_.delivery.primitives[p].textures[TextureSlot::occlusion] = number;
  }
}

void GeometryMaps::bake_positions() {
  if (!job_.options().maps.names(Map::position)) return;
  if (!box_) box_ = box_of(job_.surface.mesh.positions);
  page_.add(texture::bake_positions(page_.map(), page_.values().positions(), *box_, job_.progress, page_.pool()),
            MapKind::data, "position", false);
  page_.last_map().range = {box_->low, box_->high - box_->low};
}

void GeometryMaps::bake_displacements() {
  if (!job_.options().maps.names(Map::displacement)) return;
  if (job_.levels.empty() && page_.page() == 0) {
    job_.report.notes.push_back({"map-not-baked",
                                 "a displacement map tells how the full surface lies over a level of detail, and the "
                                 "job asks for no level: see the option lods",
                                 std::string(name_of(Map::displacement))});
  }
  for (std::size_t i = 0; i < job_.levels.size(); ++i)
    bake_displacement_of(i, "displacement_lod" + std::to_string(i + 1));
}

void GeometryMaps::bake_displacement_of(std::size_t number, const std::string& name) {
  const DetailLevel& level = job_.levels[number];
  LevelOnPages& coarse = levels_[number];
  const texture::CutMesh& mesh = level.level.mesh;
  for (const std::uint32_t t : coarse.by_page.triangles(page_.page())) {
    for (const mesh::Index v : mesh.triangles[t]) {
      const OutputVertex o = level.delivery.of_cut_vertex[v];
      const asset::NewPrimitive& primitive = level.delivery.primitives[o.primitive];
      coarse.positions[v] = Vec3f(asset::vector_at(*primitive.find("POSITION"), o.vertex));
      if (const asset::Attribute* normal = primitive.find("NORMAL"))
        coarse.normals[v] = Vec3f(asset::vector_at(*normal, o.vertex));
    }
  }
  const texture::TexelMap map = coarse.by_page.map(page_.page(), page_.pool());
  const texture::Displacement baked =
      texture::bake_displacement(page_.map(), page_.values().positions(), job_.cut.chart,
                                 {&map, &mesh, coarse.positions, coarse.normals}, job_.progress, page_.pool());
  page_.add(baked.image, MapKind::data, name, false);
  page_.last_map().range = {{baked.offset, 0, 0}, {baked.scale, 0, 0}};
}

} // namespace orbis
