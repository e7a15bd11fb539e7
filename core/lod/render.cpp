#include "core/lod/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/lod/chart_map.h"
#include "core/texture/bands.h"
#include "core/texture/raster.h"

namespace orbis::lod {
namespace {

constexpr std::uint32_t subpixels = 2; // along each side of a pixel

struct View {
  Vec3d right, up, towards; // the viewer
  Vec3d light;              // where it comes from, unit
};

View view_of(std::size_t number) {
  // The faces of a cube that was turned about no axis of symmetry.
  static const Vec3d x = normalized(Vec3d{0.86, 0.31, -0.41}), z = normalized(cross(x, Vec3d{-0.2, 0.9, 0.35}));
  static const Vec3d y = cross(z, x);
  const std::array<Vec3d, 3> axes{x, y, z};
  const double sign = number % 2 == 0 ? 1 : -1;
  const Vec3d towards = axes[number / 2 % 3] * sign, right = axes[(number / 2 + 1) % 3];
  const Vec3d up = cross(towards, right);
  return {right, up, towards, normalized(towards * 0.8 + right * -0.4 + up * 0.45)};
}

struct Fragment {
  std::uint32_t triangle = none;
  float depth = -std::numeric_limits<float>::infinity();
  float b = 0, c = 0; // weights of the second and the third corner
};

// What is seen of a surface, some rows at a time: those stay in a processor's cache, the whole picture does not.
class Viewfinder {
public:
  static constexpr std::uint32_t rows = 16 * subpixels; // of a band

  // Positions within the ball of diameter 1 around 0; size: subpixels along each side.
  Viewfinder(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles, const View& view,
             std::uint32_t size)
      : triangles_(triangles), size_(size), seen_(seen_from(positions, view, size)),
        bands_(texture::all_triangles(triangles.size()), size, rows, [this](std::uint32_t t) { return corners(t); }) {}

  [[nodiscard]] std::size_t bands() const { return bands_.count(); }

  // The fragments of a band's rows, one after the other.
  [[nodiscard]] const std::vector<Fragment>& band(std::size_t number) {
    const std::uint32_t height = bands_.rows(number);
    fragments_.assign(std::size_t{height} * size_, {});
    const auto corners_of = [this](std::uint32_t t) { return corners(t); };
    bands_.for_each(number, corners_of, [&](std::uint32_t t, const std::array<texture::RasterPoint, 3>& p) {
      const auto& [a, b, c] = triangles_[t];
      const double za = seen_[a].z, zb = seen_[b].z, zc = seen_[c].z;
      texture::rasterize(p, size_, height, [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& w) {
        Fragment& f = fragments_[std::size_t{y} * size_ + x];
        const auto depth = static_cast<float>(w[0] * za + w[1] * zb + w[2] * zc);
        if (depth > f.depth) f = {t, depth, static_cast<float>(w[1]), static_cast<float>(w[2])};
      });
    });
    return fragments_;
  }

private:
  static std::vector<Vec3d> seen_from(std::span<const Vec3d> positions, const View& view, std::uint32_t size) {
    std::vector<Vec3d> seen;
    seen.reserve(positions.size());
    for (const Vec3d& p : positions)
      seen.emplace_back(size * (0.5 + dot(p, view.right)), size * (0.5 - dot(p, view.up)), dot(p, view.towards));
    return seen;
  }
  [[nodiscard]] std::array<texture::RasterPoint, 3> corners(std::uint32_t t) const {
    std::array<texture::RasterPoint, 3> out;
    for (std::size_t k = 0; k < 3; ++k) out[k] = {seen_[triangles_[t][k]].x, seen_[triangles_[t][k]].y};
    return out;
  }

  std::span<const mesh::Triangle> triangles_;
  std::uint32_t size_;
  std::vector<Vec3d> seen_;
  texture::Bands bands_;
  std::vector<Fragment> fragments_;
};

float lit(const Vec3d& normal, const View& view) {
  const double cosine = dot(normal, view.light), squared_length = squared_norm(normal);
  return static_cast<float>(cosine > 0 ? 0.1 + 0.9 * cosine / std::sqrt(squared_length) : 0.1);
}

// normal_at(triangle, weights) for every subpixel that shows a triangle; a pixel is their mean if all do.
template <class NormalAt>
Picture shade(Viewfinder& finder, const View& view, std::uint32_t size, const NormalAt& normal_at) {
  Picture picture{size, std::vector<float>(std::size_t{size} * size, background)};
  const std::size_t width = std::size_t{size} * subpixels;
  for (std::size_t band = 0; band < finder.bands(); ++band) {
    const std::vector<Fragment>& fragments = finder.band(band);
    float* const light = &picture.light[band * (Viewfinder::rows / subpixels) * size];
    for (std::size_t pixel = 0; pixel < fragments.size() / (subpixels * subpixels); ++pixel) {
      const std::size_t x = pixel % size * subpixels, y = pixel / size * subpixels;
      float sum = 0;
      bool is_covered = true;
      for (std::size_t i = 0; i < subpixels * subpixels && is_covered; ++i) {
        const Fragment& f = fragments[(y + i / subpixels) * width + x + i % subpixels];
        is_covered = f.triangle != none;
        if (is_covered) sum += lit(normal_at(f.triangle, std::array<double, 3>{1.0 - f.b - f.c, f.b, f.c}), view);
      }
      if (is_covered) light[pixel] = sum / (subpixels * subpixels);
    }
  }
  return picture;
}

} // namespace

NormalAt interpolated(std::span<const Vec3d> normals, std::span<const mesh::Triangle> triangles) {
  return [=](std::uint32_t t, const std::array<double, 3>& w) {
    return normals[triangles[t][0]] * w[0] + normals[triangles[t][1]] * w[1] + normals[triangles[t][2]] * w[2];
  };
}

Photographer::Photographer(Sitter full, std::uint32_t size, mesh::ThreadPool& threads)
    : size_(size), threads_(threads), pictures_(views) {
  Vec3d low(full.positions.front()), high = low;
  for (const Vec3f& p : full.positions) {
    low = {std::min(low.x, double{p.x}), std::min(low.y, double{p.y}), std::min(low.z, double{p.z})};
    high = {std::max(high.x, double{p.x}), std::max(high.y, double{p.y}), std::max(high.z, double{p.z})};
  }
  centre_ = low * 0.5 + high * 0.5;
  scale_ = 1 / norm(high - low);
  threads_.for_blocks(views, 1, [&](std::size_t view, std::size_t) { pictures_[view] = of(full, view); });
}

Picture Photographer::of(const Sitter& sitter, std::size_t view) const {
  const View from = view_of(view);
  std::vector<Vec3d> positions;
  positions.reserve(sitter.positions.size());
  for (const Vec3f& p : sitter.positions) positions.push_back((Vec3d(p) - centre_) * scale_);
  Viewfinder finder(positions, sitter.triangles, from, subpixels * size_);
  return shade(finder, from, size_, sitter.normal_at);
}

double Photographer::psnr(const Sitter& level) const {
  std::array<double, views> squares{};
  std::array<std::size_t, views> pixels{};
  threads_.for_blocks(views, 1, [&](std::size_t view, std::size_t) {
    const Picture picture = of(level, view);
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
