#include "core/steps/likeness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/asset/image_codec.h"
#include "core/float4.h"
#include "core/lod/render.h"
#include "core/mesh/thread_pool.h"
#include "core/texture/sampler.h"

namespace orbis {
namespace {

using asset::TextureSlot;

constexpr std::uint32_t picture_size = 512; // pixels
constexpr double same_pictures = 99;        // dB

// The images that some primitive shows as its normal map, decoded.
class NormalImages {
public:
  explicit NormalImages(std::span<const asset::NewImage> images) : encoded_(images) {}

  const texture::Sampler* of(const asset::NewPrimitive& primitive) {
    const auto found = primitive.textures.find(TextureSlot::normal);
    if (found == primitive.textures.end()) return nullptr;
    std::optional<Decoded>& decoded = decoded_[found->second];
    if (!decoded) {
      decoded.emplace();
      decoded->image =
          asset::decode_image(encoded_[found->second].bytes, std::numeric_limits<std::uint64_t>::max(), "a normal map");
      decoded->sampler.emplace(decoded->image, texture::Wrap::clamp, texture::Wrap::clamp, 1,
                               texture::Encoding::linear);
    }
    return &*decoded->sampler;
  }

private:
  struct Decoded {
    texture::Image image;
    std::optional<texture::Sampler> sampler;
  };
  std::span<const asset::NewImage> encoded_;
  std::map<std::uint32_t, std::optional<Decoded>> decoded_; // nodes stay where they are
};

// A delivered mesh as a renderer sees it.
class Shown {
public:
  Shown(const texture::CutMesh& mesh, const Delivery& delivery) : mesh_(mesh) {
    struct Attributes {
      const asset::Attribute *position, *normal, *tangent;
    };
    std::vector<Attributes> attributes;
    for (const asset::NewPrimitive& p : delivery.primitives)
      attributes.push_back({p.find("POSITION"), p.find("NORMAL"), p.find("TANGENT")});
    vertices_.resize(mesh.vertices.size());
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      const OutputVertex o = delivery.of_cut_vertex[v];
      const Attributes& a = attributes[o.primitive];
      positions_.emplace_back(asset::vector_at(*a.position, o.vertex));
      const Vec3d normal = a.normal != nullptr ? Vec3d(asset::vector_at(*a.normal, o.vertex)) : Vec3d{};
      vertices_[v].normal = float4(normal, 0);
      if (a.tangent == nullptr) continue;
      const Vec3d tangent(asset::vector_at(*a.tangent, o.vertex));
      vertices_[v].tangent_u = float4(tangent, mesh.vertices[v].uv.x);
      vertices_[v].bitangent_v = float4(cross(normal, tangent) * a.tangent->get(o.vertex, 3), mesh.vertices[v].uv.y);
    }
    primitive_.reserve(mesh.triangles.size());
    for (const mesh::Triangle& t : mesh.triangles) primitive_.push_back(delivery.of_cut_vertex[t[0]].primitive);
  }

  // maps: by primitive, null for none. flat: by primitive, whether its triangles' own normals are shown.
  [[nodiscard]] lod::Sitter with(std::vector<const texture::Sampler*> maps, std::vector<bool> flat) const {
    const auto normals_at = [this, maps = std::move(maps), flat = std::move(flat)](std::span<const lod::Spot> spots,
                                                                                   std::span<Vec3f> out) {
      for (std::size_t i = 0; i < spots.size(); ++i) {
        const std::uint32_t primitive = primitive_[spots[i].triangle];
        if (flat[primitive])
          out[i] = face_normal(spots[i].triangle);
        else
          out[i] = maps[primitive] == nullptr ? interpolated(spots[i]) : mapped(spots[i], *maps[primitive]);
      }
    };
    return {positions_, mesh_.triangles, normals_at};
  }

private:
  struct Vertex {
    Float4 normal{}, tangent_u{}, bitangent_v{}; // the last two with a coordinate in the atlas behind them
  };

  [[nodiscard]] Float4 blend(const lod::Spot& spot, Float4 Vertex::*of) const {
    const auto& [a, b, c] = mesh_.triangles[spot.triangle];
    return vertices_[a].*of * (1 - spot.b - spot.c) + vertices_[b].*of * spot.b + vertices_[c].*of * spot.c;
  }
  [[nodiscard]] Vec3f interpolated(const lod::Spot& spot) const {
    const Float4 n = blend(spot, &Vertex::normal);
    return {n[0], n[1], n[2]};
  }
  [[nodiscard]] Vec3f face_normal(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    const Vec3d n = cross(Vec3d(positions_[b]) - Vec3d(positions_[a]), Vec3d(positions_[c]) - Vec3d(positions_[a]));
    const double length = norm(n); // of tiny triangles too small for float
    return Vec3f(length > 0 ? n * (1 / length) : n);
  }
  // n ~ x T + y B + z N, each brought back to unit length.
  [[nodiscard]] Vec3f mapped(const lod::Spot& spot, const texture::Sampler& map) const {
    const Float4 t = blend(spot, &Vertex::tangent_u), b = blend(spot, &Vertex::bitangent_v),
                 n = blend(spot, &Vertex::normal);
    const texture::Page& page = mesh_.pages[mesh_.page_of(spot.triangle)];
    const texture::Light c = map.sample(double{t[3]} * page.width, double{b[3]} * page.height, 0);
    const Float4 sum =
        t * ((2 * c[0] - 1) / norm3(t)) + b * ((2 * c[1] - 1) / norm3(b)) + n * ((2 * c[2] - 1) / norm3(n));
    return {sum[0], sum[1], sum[2]};
  }

  const texture::CutMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> primitive_; // by triangle
};

} // namespace

void measure_likeness(const asset::Asset& asset, const texture::CutMesh& cut, const Delivery& full,
                      std::span<const DetailLevel> levels, const BakedMaps& maps, const Progress& progress,
                      Report& report) {
  if (levels.empty()) return;
  NormalImages images(maps.images);
  const std::size_t primitives = asset.primitives.size();
  std::vector<bool> came_flat(primitives);
  std::vector<const texture::Sampler*> original(primitives);
  for (std::size_t p = 0; p < primitives; ++p) {
    came_flat[p] = asset.primitives[p].find("NORMAL") == nullptr;
    if (asset::names_texture(asset, asset.primitives[p], TextureSlot::normal))
      original[p] = images.of(full.primitives[p]);
  }
  mesh::ThreadPool threads(report.options.threads);
  const Shown shown(cut, full);
  const lod::Photographer photographer(shown.with(original, came_flat), picture_size, threads);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    progress.check();
    const DetailLevel& level = levels[i];
    std::vector<const texture::Sampler*> delivered(primitives);
    std::vector<bool> flat(primitives);
    for (std::size_t p = 0; p < primitives; ++p) {
      delivered[p] = images.of(level.delivery.primitives[p]);
      flat[p] = came_flat[p] && delivered[p] == nullptr;
    }
    const Shown coarse(level.level.mesh, level.delivery);
    report.levels[i].psnr = std::min(photographer.psnr(coarse.with(delivered, flat)), same_pictures);
  }
}

} // namespace orbis
