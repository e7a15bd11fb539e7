#include "core/steps/likeness.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/asset/image_codec.h"
#include "core/lod/render.h"
#include "core/mesh/thread_pool.h"
#include "core/texture/sampler.h"

namespace orbis {
namespace {

using asset::TextureSlot;
using Weights = std::array<double, 3>;

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
      vertices_[v].primitive = o.primitive;
      if (a.normal != nullptr) vertices_[v].normal = asset::vector_at(*a.normal, o.vertex);
      if (a.tangent == nullptr) continue;
      vertices_[v].tangent = asset::vector_at(*a.tangent, o.vertex);
      vertices_[v].bitangent = cross(vertices_[v].normal, vertices_[v].tangent) * a.tangent->get(o.vertex, 3);
    }
  }

  // maps: by primitive, null for none. flat: by primitive, whether its triangles' own normals are shown.
  [[nodiscard]] lod::Sitter with(std::vector<const texture::Sampler*> maps, std::vector<bool> flat) const {
    const auto normal_at = [this, maps = std::move(maps), flat = std::move(flat)](std::uint32_t t, const Weights& w) {
      const std::uint32_t primitive = vertices_[mesh_.triangles[t][0]].primitive;
      if (flat[primitive]) return face_normal(t);
      const Vec3d n = blend(t, w, &Vertex::normal);
      return maps[primitive] == nullptr ? n : mapped(t, w, n, *maps[primitive]);
    };
    return {positions_, mesh_.triangles, normal_at};
  }

private:
  struct Vertex {
    std::uint32_t primitive = 0;
    Vec3d normal, tangent, bitangent;
  };

  [[nodiscard]] Vec3d blend(std::uint32_t t, const Weights& w, Vec3d Vertex::*of) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return vertices_[a].*of * w[0] + vertices_[b].*of * w[1] + vertices_[c].*of * w[2];
  }
  [[nodiscard]] Vec3d face_normal(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return cross(Vec3d(positions_[b]) - Vec3d(positions_[a]), Vec3d(positions_[c]) - Vec3d(positions_[a]));
  }
  // n ~ x T + y B + z N, each brought back to unit length.
  [[nodiscard]] Vec3d mapped(std::uint32_t t, const Weights& w, const Vec3d& n, const texture::Sampler& map) const {
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x += w[k] * mesh_.vertices[mesh_.triangles[t][k]].uv.x;
      y += w[k] * mesh_.vertices[mesh_.triangles[t][k]].uv.y;
    }
    const texture::Page& page = mesh_.pages[mesh_.page_of(t)];
    const texture::Light c = map.sample(x * page.width, y * page.height, 0);
    return normalized(blend(t, w, &Vertex::tangent)) * (2.0 * c[0] - 1) +
           normalized(blend(t, w, &Vertex::bitangent)) * (2.0 * c[1] - 1) + normalized(n) * (2.0 * c[2] - 1);
  }

  const texture::CutMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::vector<Vertex> vertices_;
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
