// What the input says at the corners of the delivered triangles, each corner seen from its own triangle: where two
// triangles meet with different texture coordinates, each gets its own.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/groups.h"
#include "core/mesh/thread_pool.h"
#include "core/steps/surface.h"
#include "core/texture/bake_maps.h"

namespace orbis {

class CornerValues {
public:
  // Keeps references to all of them.
  CornerValues(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut, mesh::ThreadPool& pool);

  // The delivered triangles that are asked for below, which have to stay where they are; none until this is called. A
  // primitive is shown with all of its triangles or with none.
  void show(std::span<const std::uint32_t> triangles) { shown_ = triangles; }
  [[nodiscard]] std::span<const std::uint32_t> shown() const { return shown_; }

  // All have one entry per delivered triangle, of which those shown are filled, with zeros where the primitive lacks
  // the attribute. They are good until the same is asked for again, be it of other triangles: one list for all pages,
  // since to make one for each would cost pages times triangles.

  // uv_of: the attribute to read by primitive, null for none.
  [[nodiscard]] std::span<const texture::CornerUv> uv(std::span<const asset::Attribute* const> uv_of);
  [[nodiscard]] std::span<const std::array<Vec3f, 3>> positions();
  // NORMAL, or the triangle's own normal where the primitive has none, as glTF asks for.
  [[nodiscard]] std::span<const std::array<Vec3f, 3>> normals();
  // COLOR_0 in [0, 1] of the primitives that are `wanted`, else white.
  [[nodiscard]] std::span<const texture::CornerColor> colors(const std::vector<bool>& wanted);
  // The frames of the input's normal maps: TANGENT where a primitive has both it and NORMAL, else by MikkTSpace from
  // the texture coordinates uv_of, brought into place by its transform.
  struct NormalUv {
    const asset::Attribute* uv = nullptr; // null: no normal map
    std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
  };
  [[nodiscard]] std::span<const std::array<texture::Tangent, 3>> tangents(std::span<const NormalUv> uv_of);

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
  template <class Value, class Fill> std::span<const Value> gather(std::vector<Value>& out, Fill fill);
  [[nodiscard]] std::vector<std::array<texture::Tangent, 3>> mikktspace(std::uint32_t primitive,
                                                                        const NormalUv& uv) const;
  void add_mikktspace(std::uint32_t primitive, const NormalUv& uv);

  const asset::Asset& asset_;
  const Surface& surface_;
  const texture::CutMesh& cut_;
  mesh::ThreadPool& pool_;
  mesh::Groups of_surface_, of_cut_; // triangles of the surface, and delivered ones, by primitive
  std::span<const std::uint32_t> shown_;
  std::vector<texture::CornerUv> uv_;
  std::vector<std::array<Vec3f, 3>> positions_, normals_;
  std::vector<texture::CornerColor> colors_;
  std::vector<std::array<texture::Tangent, 3>> tangents_;
};

} // namespace orbis
