#include "core/lod/render.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/texture/canvas.h"
#include "core/texture/raster.h"

namespace orbis::lod {
namespace {

constexpr std::uint32_t subpixels = 2; // along each side of a pixel

struct View {
  Vec3d right, up, towards; // the viewer
};

View view_of(std::size_t number) {
  // The faces of a cube that was turned about no axis of symmetry.
  static const Vec3d x = normalized(Vec3d{0.86, 0.31, -0.41}), z = normalized(cross(x, Vec3d{-0.2, 0.9, 0.35}));
  static const Vec3d y = cross(z, x);
  const std::array<Vec3d, 3> axes{x, y, z};
  const double sign = number % 2 == 0 ? 1 : -1;
  const Vec3d towards = axes[number / 2 % 3] * sign, right = axes[(number / 2 + 1) % 3];
  return {right, cross(towards, right), towards};
}

struct Fragment {
  std::uint32_t triangle = none;
  float depth = -std::numeric_limits<float>::infinity();
  float b = 0, c = 0; // weights of the second and the third corner
};

// Positions as in FullSurface: within the unit sphere's half.
std::vector<Fragment> visible(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                              const View& view, std::uint32_t size) {
  std::vector<Fragment> fragments(std::size_t{size} * size);
  std::vector<Vec3d> seen;
  seen.reserve(positions.size());
  for (const Vec3d& p : positions)
    seen.emplace_back(size * (0.5 + dot(p, view.right)), size * (0.5 - dot(p, view.up)), dot(p, view.towards));
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3d &a = seen[triangles[t][0]], &b = seen[triangles[t][1]], &c = seen[triangles[t][2]];
    texture::rasterize({{{a.x, a.y}, {b.x, b.y}, {c.x, c.y}}}, size, size,
                       [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& w) {
                         Fragment& f = fragments[std::size_t{y} * size + x];
                         const auto depth = static_cast<float>(w[0] * a.z + w[1] * b.z + w[2] * c.z);
                         if (depth > f.depth) f = {t, depth, static_cast<float>(w[1]), static_cast<float>(w[2])};
                       });
  }
  return fragments;
}

float lit(const Vec3d& normal, const View& view) {
  const Vec3d light = normalized(view.towards * 0.8 + view.right * -0.4 + view.up * 0.45);
  const double length = norm(normal);
  const double cosine = length > 0 ? dot(normal, light) / length : 0;
  return static_cast<float>(0.1 + 0.9 * std::max(cosine, 0.0));
}

// normal_at(triangle, weights) for every subpixel that shows a triangle; a pixel is their mean if all do.
template <class NormalAt>
Picture shade(const std::vector<Fragment>& fragments, const View& view, std::uint32_t size, const NormalAt& normal_at) {
  Picture picture{size, std::vector<float>(std::size_t{size} * size, background)};
  for (std::size_t pixel = 0; pixel < picture.light.size(); ++pixel) {
    const std::size_t x = pixel % size * subpixels, y = pixel / size * subpixels;
    float sum = 0;
    bool is_covered = true;
    for (std::size_t i = 0; i < subpixels * subpixels && is_covered; ++i) {
      const Fragment& f = fragments[(y + i / subpixels) * size * subpixels + x + i % subpixels];
      is_covered = f.triangle != none;
      if (is_covered) sum += lit(normal_at(f.triangle, std::array<double, 3>{1.0 - f.b - f.c, f.b, f.c}), view);
    }
    if (is_covered) picture.light[pixel] = sum / (subpixels * subpixels);
  }
  return picture;
}

template <class T> Vec3d blend(std::span<const T> at, const mesh::Triangle& t, const std::array<double, 3>& w) {
  return at[t[0]] * w[0] + at[t[1]] * w[1] + at[t[2]] * w[2];
}

} // namespace

Photographer::Photographer(const FullSurface& full, std::span<const Vec3d> normals, std::uint32_t size,
                           mesh::ThreadPool& threads)
    : full_(full), normals_(normals), size_(size), threads_(threads), map_(full, normals), pictures_(views) {
  threads_.for_blocks(views, 1, [&](std::size_t view, std::size_t) { pictures_[view] = of_full(view); });
}

Picture Photographer::of_full(std::size_t view) const {
  const View from = view_of(view);
  const auto& triangles = full_.cut().triangles;
  return shade(visible(full_.positions(), triangles, from, subpixels * size_), from, size_,
               [&](std::uint32_t t, const std::array<double, 3>& w) { return blend(normals_, triangles[t], w); });
}

Picture Photographer::of(const Level& level, Shading shading, std::size_t view) const {
  const View from = view_of(view);
  const auto& triangles = level.mesh.triangles;
  std::vector<Vec3d> positions;
  positions.reserve(level.positions.size());
  for (const Vec3f& p : level.positions) positions.push_back(full_.in_scale(p));
  const std::vector<Fragment> fragments = visible(positions, triangles, from, subpixels * size_);
  if (shading == Shading::own_normals) {
    const std::vector<Vec3d> normals = texture::smooth_normals(level.mesh, positions);
    return shade(fragments, from, size_, [&](std::uint32_t t, const std::array<double, 3>& w) {
      return blend<Vec3d>(normals, triangles[t], w);
    });
  }
  return shade(fragments, from, size_, [&](std::uint32_t t, const std::array<double, 3>& w) {
    Uv uv{};
    for (std::size_t k = 0; k < 3; ++k) {
      uv[0] += w[k] * level.mesh.vertices[triangles[t][k]].uv.x;
      uv[1] += w[k] * level.mesh.vertices[triangles[t][k]].uv.y;
    }
    return map_.at(uv, level.mesh.page_of(t));
  });
}

double Photographer::psnr(const Level& level, Shading shading) const {
  std::array<double, views> squares{};
  std::array<std::size_t, views> pixels{};
  threads_.for_blocks(views, 1, [&](std::size_t view, std::size_t) {
    const Picture picture = of(level, shading, view);
    const Picture& original = pictures_[view];
    for (std::size_t i = 0; i < picture.light.size(); ++i) {
      if (picture.light[i] == background || original.light[i] == background) continue;
      const double d = double{picture.light[i]} - double{original.light[i]};
      squares[view] += d * d;
      ++pixels[view];
    }
  });
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t view = 0; view < views; ++view) {
    sum += squares[view];
    count += pixels[view];
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return -10 * std::log10(sum / static_cast<double>(count));
}

} // namespace orbis::lod
