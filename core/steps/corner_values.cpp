#include "core/steps/corner_values.h"

#include <algorithm>
#include <cmath>

namespace orbis {
namespace {

using texture::Tangent;

constexpr std::size_t triangles_a_block = 4096;

Vec3f vector_of(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vec3f unit(const Vec3d& v) {
  const double length = norm(v);
  return length > 0 ? Vec3f(v * (1 / length)) : Vec3f{0, 0, 1};
}

const asset::Attribute* color_of(const asset::Primitive& p) {
  const asset::Attribute* color = p.find("COLOR_0");
  return color != nullptr && color->components >= 3 ? color : nullptr;
}

} // namespace

CornerValues::CornerValues(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                           mesh::ThreadPool& pool)
    : asset_(asset), surface_(surface), cut_(cut), pool_(pool),
      of_surface_(surface.primitive_of.size(), asset.primitives.size(),
                  [&](std::uint32_t t) { return surface.primitive_of[t]; }),
      of_cut_(cut.triangles.size(), asset.primitives.size(), [&](std::uint32_t t) { return primitive(t); }) {}

std::array<double, 3> CornerValues::weights_in_parent(std::size_t t, std::size_t k) const {
  return texture::weights_on(cut_.parent[t], surface_.mesh.triangles, cut_.vertices[cut_.triangles[t][k]]);
}

// Calls fill(t, value) for every triangle shown, whose value is zero.
template <class Value, class Fill> std::span<const Value> CornerValues::gather(std::vector<Value>& out, Fill fill) {
  out.resize(cut_.triangles.size());
  pool_.for_blocks(shown_.size(), triangles_a_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out[shown_[i]] = {};
      fill(shown_[i], out[shown_[i]]);
    }
  });
  return out;
}

std::span<const texture::CornerUv> CornerValues::uv(std::span<const asset::Attribute* const> uv_of) {
  return gather(uv_, [&](std::size_t t, texture::CornerUv& out) {
    const asset::Attribute* attribute = uv_of[primitive(t)];
    for (std::size_t k = 0; attribute != nullptr && k < 3; ++k) {
      const auto [u, v] = at<2>(*attribute, t, k);
      out[k] = {static_cast<float>(u), static_cast<float>(v)};
    }
  });
}

std::span<const std::array<Vec3f, 3>> CornerValues::positions() {
  return gather(positions_, [&](std::size_t t, std::array<Vec3f, 3>& out) {
    const asset::Attribute& attribute = *asset_.primitives[primitive(t)].find("POSITION");
    for (std::size_t k = 0; k < 3; ++k) out[k] = vector_of(at<3>(attribute, t, k));
  });
}

std::span<const std::array<Vec3f, 3>> CornerValues::normals() {
  return gather(normals_, [&](std::size_t t, std::array<Vec3f, 3>& out) {
    const asset::Attribute* attribute = asset_.primitives[primitive(t)].find("NORMAL");
    if (attribute != nullptr) {
      for (std::size_t k = 0; k < 3; ++k) out[k] = vector_of(at<3>(*attribute, t, k));
      return;
    }
    const auto& [a, b, c] = surface_.mesh.triangles[cut_.parent[t]];
    const auto position = [&](mesh::Index v) { return Vec3d(surface_.mesh.positions[v]); };
    out.fill(unit(cross(position(b) - position(a), position(c) - position(a))));
  });
}

std::span<const texture::CornerColor> CornerValues::colors(const std::vector<bool>& wanted) {
  return gather(colors_, [&](std::size_t t, texture::CornerColor& out) {
    const std::uint32_t p = primitive(t);
    const asset::Attribute* attribute = wanted[p] ? color_of(asset_.primitives[p]) : nullptr;
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = {1, 1, 1, 1};
      if (attribute == nullptr) continue;
      const auto rgb = at<3>(*attribute, t, k);
      for (std::size_t c = 0; c < 3; ++c) out[k][c] = static_cast<float>(std::clamp(rgb[c], 0.0, 1.0));
      if (attribute->components == 4) out[k][3] = static_cast<float>(std::clamp(at<4>(*attribute, t, k)[3], 0.0, 1.0));
    }
  });
}

std::span<const std::array<Tangent, 3>> CornerValues::tangents(std::span<const NormalUv> uv_of) {
  const auto given = [&](std::uint32_t p) {
    const asset::Attribute* tangent = asset_.primitives[p].find("TANGENT");
    return tangent != nullptr && tangent->components == 4 && asset_.primitives[p].find("NORMAL") != nullptr ? tangent
                                                                                                            : nullptr;
  };
  const auto out = gather(tangents_, [&](std::size_t t, std::array<Tangent, 3>& corners) {
    const asset::Attribute* attribute = given(primitive(t));
    for (std::size_t k = 0; attribute != nullptr && k < 3; ++k) {
      const auto v = at<4>(*attribute, t, k);
      corners[k] = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                    v[3] < 0 ? -1.0F : 1.0F};
    }
  });
  for (std::uint32_t p = 0; p < uv_of.size(); ++p) {
    if (uv_of[p].uv != nullptr && given(p) == nullptr) add_mikktspace(p, uv_of[p]);
  }
  return out;
}

// By triangle of the surface that is the primitive's, as a renderer of the input does it.
std::vector<std::array<Tangent, 3>> CornerValues::mikktspace(std::uint32_t p, const NormalUv& uv) const {
  const asset::Primitive& source = asset_.primitives[p];
  const std::vector<Vec3f> positions = source.positions();
  const asset::Attribute* normal = source.find("NORMAL");
  std::vector<Vec3f> at_position, at_normal;
  std::vector<Vec2f> at_uv;
  for (const std::uint32_t s : of_surface_[p]) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k] = surface_.corners[s][k] - surface_.first_vertex[p];
    const Vec3d a(positions[corner[0]]), b(positions[corner[1]]), c(positions[corner[2]]);
    const Vec3f flat = unit(cross(b - a, c - a));
    for (const std::uint32_t v : corner) {
      at_position.push_back(positions[v]);
      at_normal.push_back(normal == nullptr ? flat
                                            : vector_of({normal->get(v, 0), normal->get(v, 1), normal->get(v, 2)}));
      const double x = uv.uv->get(v, 0), y = uv.uv->get(v, 1);
      const auto& m = uv.transform;
      at_uv.push_back({static_cast<float>(m[0] * x + m[1] * y + m[2]), static_cast<float>(m[3] * x + m[4] * y + m[5])});
    }
  }
  std::vector<mesh::Triangle> triangles(at_uv.size() / 3);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) triangles[t] = {3 * t, 3 * t + 1, 3 * t + 2};
  return texture::corner_tangents(at_position, at_normal, at_uv, triangles);
}

// Carried over from the input's triangles to the pieces.
void CornerValues::add_mikktspace(std::uint32_t p, const NormalUv& uv) {
  const std::vector<std::array<Tangent, 3>> corners = mikktspace(p, uv);
  const std::span<const std::uint32_t> sources = of_surface_[p];
  for (const std::uint32_t t : of_cut_[p]) {
    const auto number = std::ranges::lower_bound(sources, cut_.parent[t]) - sources.begin();
    const std::array<Tangent, 3>& from = corners[static_cast<std::size_t>(number)];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<double, 3> w = weights_in_parent(t, k);
      Vec3d sum;
      for (std::size_t j = 0; j < 3; ++j) sum += Vec3d{from[j].x, from[j].y, from[j].z} * w[j];
      tangents_[t][k] = {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z), from[0].w};
    }
  }
}

} // namespace orbis
