// What the input says at the corners of the delivered triangles, each corner seen from its own triangle: where two
// triangles meet with different texture coordinates, each gets its own.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/thread_pool.h"
#include "core/steps/surface.h"
#include "core/texture/bake_maps.h"

namespace orbis {

class CornerValues {
public:
  // Keeps references to all of them.
  CornerValues(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut, mesh::ThreadPool& pool);

  // The delivered triangles that are asked for below; all of them until this is called.
  void show(std::vector<std::uint32_t> triangles) { shown_ = std::move(triangles); }
  [[nodiscard]] const std::vector<std::uint32_t>& shown() const { return shown_; }

  // All have one entry per delivered triangle, of which those shown are filled; so are not those of a primitive without
  // the attribute.

  // uv_of: the attribute to read by primitive, null for none.
  [[nodiscard]] std::vector<texture::CornerUv> uv(std::span<const asset::Attribute* const> uv_of) const;
  [[nodiscard]] std::vector<std::array<Vec3f, 3>> positions() const;
  // NORMAL, or the triangle's own normal where the primitive has none, as glTF asks for.
  [[nodiscard]] std::vector<std::array<Vec3f, 3>> normals() const;
  // COLOR_0 in [0, 1] of the primitives that are `wanted`, else white.
  [[nodiscard]] std::vector<texture::CornerColor> colors(const std::vector<bool>& wanted) const;
  // The frames of the input's normal maps: TANGENT where a primitive has both it and NORMAL, else by MikkTSpace from
  // the texture coordinates uv_of, brought into place by its transform.
  struct NormalUv {
    const asset::Attribute* uv = nullptr; // null: no normal map
    std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
  };
  [[nodiscard]] std::vector<std::array<texture::Tangent, 3>> tangents(std::span<const NormalUv> uv_of) const;

  // Delivered triangle -> primitive of the asset.
  [[nodiscard]] std::uint32_t primitive(std::size_t t) const { return surface_.primitive_of[cut_.parent[t]]; }
  // The weights of corner k of delivered triangle t on the corners of the input triangle that it was cut from.
  [[nodiscard]] std::array<double, 3> weights_in_parent(std::size_t t, std::size_t k) const;
  // Components [0, N) of an attribute of the triangle's primitive at one of its corners.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> at(const asset::Attribute& attribute, std::size_t t, std::size_t k) const {
    const std::array<double, 3> weights = weights_in_parent(t, k);
    const mesh::Triangle& corners = surface_.corners[cut_.parent[t]];
    const std::uint32_t first = surface_.first_vertex[primitive(t)];
    std::array<double, N> sum{};
    for (std::size_t j = 0; j < 3; ++j) {
      if (weights[j] == 0) continue;
      for (std::uint32_t c = 0; c < N; ++c) sum[c] += weights[j] * attribute.get(corners[j] - first, c);
    }
    return sum;
  }

private:
  template <class Value, class Fill> std::vector<Value> gather(Fill fill) const;
  void add_mikktspace(std::uint32_t primitive, const NormalUv& uv,
                      std::vector<std::array<texture::Tangent, 3>>& out) const;

  const asset::Asset& asset_;
  const Surface& surface_;
  const texture::CutMesh& cut_;
  mesh::ThreadPool& pool_;
  std::vector<std::uint32_t> shown_;
};

} // namespace orbis
