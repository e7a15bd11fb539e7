#include "core/texture/bake_occlusion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/texture/color.h"
#include "core/texture/shade.h"

namespace orbis::texture {
namespace {

// The digits of i in base 2 behind the point, reversed (van der Corput).
float radical_inverse(std::uint32_t i) {
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < 32; ++k) bits |= (i >> k & 1U) << (31U - k);
  return static_cast<float>(bits >> 8U) * 0x1p-24F;
}

// Two well-mixed numbers in [0, 1) for each texel (a Weyl sequence through a 64-bit finaliser).
std::array<float, 2> turn_of(std::uint64_t texel) {
  std::uint64_t h = (texel + 1) * 0x9E3779B97F4A7C15U;
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9U;
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBU;
  h ^= h >> 31U;
  return {static_cast<float>(h >> 40U) * 0x1p-24F, static_cast<float>(h & 0xFFFFFFU) * 0x1p-24F};
}

float fraction(float x) { return x - std::floor(x); }

// Directions around +z, as dense as the cosine.
std::vector<std::array<float, 2>> hammersley() {
  std::vector<std::array<float, 2>> out;
  for (std::uint32_t i = 0; i < rays_a_texel; ++i) {
    out.push_back({(static_cast<float>(i) + 0.5F) / rays_a_texel, radical_inverse(i)});
  }
  return out;
}

class OcclusionShader {
public:
  OcclusionShader(std::span<const std::array<Vec3f, 3>> positions, std::span<const std::array<Vec3f, 3>> normals,
                  const Occluders& occluders, const std::vector<bool>& two_sided, float offset, std::uint32_t width,
                  std::vector<float>& seen)
      : positions_(positions), normals_(normals), occluders_(occluders), two_sided_(two_sided), offset_(offset),
        width_(width), seen_(seen), samples_(hammersley()) {}

  void triangle(std::uint32_t t, const TriangleInPage&) {
    triangle_ = t;
    const auto& [a, b, c] = positions_[t];
    const Vec3f n = cross(b - a, c - a);
    const float length = norm(n);
    flat_ = length > 0 ? n * (1 / length) : normals_[t][0];
  }

  void texel(std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
    const std::size_t texel = std::size_t{y} * width_ + x;
    const Vec3f normal = unit(blend(normals_[triangle_], weights)), at = blend(positions_[triangle_], weights);
    seen_[texel] = sky_above(at, normal, flat_, texel);
    if (!two_sided_.empty() && two_sided_[triangle_])
      seen_[texel] = std::max(seen_[texel], sky_above(at, -normal, -flat_, texel));
  }

private:
  // flat: the triangle's own normal on this side.
  [[nodiscard]] float sky_above(const Vec3f& at, const Vec3f& normal, const Vec3f& flat, std::size_t texel) const {
    const Vec3f origin = at + flat * offset_;
    const Vec3f u = unit(std::abs(normal.x) < 0.6F ? cross(normal, {1, 0, 0}) : cross(normal, {0, 1, 0}));
    const Vec3f v = cross(normal, u);
    const OccluderTree& tree = occluders_.trees[occluders_.tree_of[triangle_]];
    const std::uint32_t component = occluders_.component_of[triangle_];
    const auto [turn, shift] = turn_of(texel);
    std::uint32_t cast = 0, hidden = 0;
    for (const auto& [s, t] : samples_) {
      const float angle = 2 * std::numbers::pi_v<float> * fraction(s + turn), square = fraction(t + shift);
      const float r = std::sqrt(square), up = std::sqrt(1 - square);
      const Vec3f direction = u * (r * std::cos(angle)) + v * (r * std::sin(angle)) + normal * up;
      if (dot(direction, flat) <= 0) continue;
      ++cast;
      if (tree.hides(origin, direction, component)) ++hidden;
    }
    return cast > 0 ? 1 - static_cast<float>(hidden) / static_cast<float>(cast) : 1;
  }

  static Vec3f blend(const std::array<Vec3f, 3>& corners, const std::array<double, 3>& w) {
    return corners[0] * static_cast<float>(w[0]) + corners[1] * static_cast<float>(w[1]) +
           corners[2] * static_cast<float>(w[2]);
  }
  [[nodiscard]] Vec3f unit(const Vec3f& v) const {
    const float length = norm(v);
    return length > 0 ? v * (1 / length) : flat_;
  }

  std::span<const std::array<Vec3f, 3>> positions_, normals_;
  const Occluders& occluders_;
  const std::vector<bool>& two_sided_;
  float offset_;
  std::uint32_t width_;
  std::vector<float>& seen_;
  std::vector<std::array<float, 2>> samples_;
  std::uint32_t triangle_ = 0;
  Vec3f flat_;
};

// The mean over a texel and those of its eight neighbours that show the surface themselves: the turned samples make
// neighbours' errors independent.
float smoothed(const TexelMap& map, const std::vector<float>& seen, std::uint32_t x, std::uint32_t y) {
  if (!map.covered(x, y)) return seen[std::size_t{y} * map.width() + x];
  float sum = 0;
  int count = 0;
  for (std::uint32_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, map.height() - 1); ++j) {
    for (std::uint32_t i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, map.width() - 1); ++i) {
      if (!map.covered(i, j)) continue;
      sum += seen[std::size_t{j} * map.width() + i];
      ++count;
    }
  }
  return sum / static_cast<float>(count);
}

} // namespace

Image bake_occlusion(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions,
                     std::span<const std::array<Vec3f, 3>> normals, const Occluders& occluders,
                     const std::vector<bool>& two_sided, float offset, const Progress& progress,
                     mesh::ThreadPool& pool) {
  std::vector<float> seen(std::size_t{map.width()} * map.height(), 1);
  constexpr std::size_t texels_a_look = std::size_t{1} << 15U;
  shade(
      map, pool, progress,
      [&] { return OcclusionShader(positions, normals, occluders, two_sided, offset, map.width(), seen); },
      texels_a_look);
  Image image{map.width(), map.height(), 3, {}};
  image.pixels.reserve(3 * seen.size());
  for (std::uint32_t y = 0; y < map.height(); ++y) {
    for (std::uint32_t x = 0; x < map.width(); ++x)
      image.pixels.insert(image.pixels.end(), 3, to_byte(smoothed(map, seen, x, y)));
  }
  return image;
}

} // namespace orbis::texture
