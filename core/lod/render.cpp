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

// What is seen of a surface, some rows at a time: those stay in a processor's cache, the whole picture does not.
class Viewfinder {
public:
  static constexpr std::uint32_t rows = 16 * subpixels; // of a band

  // Positions within the ball of diameter 1 around 0; size: subpixels along each side.
  Viewfinder(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles, const View& view,
             std::uint32_t size)
      : triangles_(triangles), size_(size), seen_(seen_from(positions, view, size)),
        bands_(texture::all_triangles(triangles.size()), size, rows, [this](std::uint32_t t) { return corners(t); }),
        depth_(std::size_t{rows} * size), shown_(depth_.size()) {}

  [[nodiscard]] std::size_t bands() const { return bands_.count(); }

  // The triangles at the subpixels of a band, row by row; `none` where there is none.
  [[nodiscard]] std::span<const std::uint32_t> band(std::size_t number) {
    const std::uint32_t height = bands_.rows(number);
    std::fill(depth_.begin(), depth_.end(), -std::numeric_limits<float>::infinity());
    std::fill(shown_.begin(), shown_.end(), none);
    const auto corners_of = [this](std::uint32_t t) { return corners(t); };
    bands_.for_each(number, corners_of, [&](std::uint32_t t, const std::array<texture::RasterPoint, 3>& p) {
      texture::rasterize_rows(p, size_, height, [&](const texture::CoveredRow& row) { draw(t, row); });
    });
    return std::span(shown_).first(std::size_t{height} * size_);
  }

  // The point of a triangle that is seen in the middle of a subpixel.
  [[nodiscard]] Spot spot(std::uint32_t t, std::size_t x, std::size_t y) const {
    const auto& [a, b, c] = triangles_[t];
    const Vec3d ab = seen_[b] - seen_[a], ac = seen_[c] - seen_[a];
    const double dx = static_cast<double>(x) + 0.5 - seen_[a].x, dy = static_cast<double>(y) + 0.5 - seen_[a].y;
    const double area = ab.x * ac.y - ac.x * ab.y, scale = area != 0 ? 1 / area : 0;
    const double at_b = std::clamp((dx * ac.y - ac.x * dy) * scale, 0.0, 1.0);
    return {t, static_cast<float>(at_b),
            static_cast<float>(std::clamp((ab.x * dy - dx * ab.y) * scale, 0.0, 1 - at_b))};
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
  void draw(std::uint32_t t, const texture::CoveredRow& row) {
    const auto depth_at = [&](std::uint32_t x) {
      const std::array<double, 3> w = row.weights(x);
      return w[0] * seen_[triangles_[t][0]].z + w[1] * seen_[triangles_[t][1]].z + w[2] * seen_[triangles_[t][2]].z;
    };
    const double first = depth_at(row.begin);
    const double step = row.end - row.begin > 1 ? (depth_at(row.end - 1) - first) / (row.end - 1 - row.begin) : 0;
    float* const depth = &depth_[std::size_t{row.y} * size_ + row.begin];
    std::uint32_t* const shown = &shown_[std::size_t{row.y} * size_ + row.begin];
    for (std::uint32_t i = 0; i < row.end - row.begin; ++i) {
      const auto here = static_cast<float>(first + i * step);
      if (here <= depth[i]) continue;
      depth[i] = here;
      shown[i] = t;
    }
  }

  std::span<const mesh::Triangle> triangles_;
  std::uint32_t size_;
  std::vector<Vec3d> seen_;
  texture::Bands bands_;
  std::vector<float> depth_;
  std::vector<std::uint32_t> shown_;
};

// The brightness of a pixel is the mean of its subpixels', if all of them show a triangle.
class Shader {
public:
  Shader(Viewfinder& finder, const NormalsAt& normals_at, const View& view, Picture& picture)
      : finder_(finder), normals_at_(normals_at), light_(view.light), picture_(picture) {}

  void shade(std::size_t band) {
    const std::span<const std::uint32_t> shown = finder_.band(band);
    const std::size_t size = picture_.size, width = size * subpixels;
    pixels_.clear();
    spots_.clear();
    // Tile by tile: what lies close together in the picture does so in the atlas, and in the cache.
    for (std::size_t left = 0; left < size; left += tile)
      for (std::size_t row = 0; row < shown.size() / width / subpixels; ++row)
        for (std::size_t column = left; column < std::min(left + tile, size); ++column)
          collect(shown, band, row, column);
    light();
  }

private:
  static constexpr std::size_t samples = std::size_t{subpixels} * subpixels; // a pixel
  static constexpr std::size_t tile = 8;                                     // pixels

  // The subpixels of a pixel in a band, if all of them show a triangle.
  void collect(std::span<const std::uint32_t> shown, std::size_t band, std::size_t row, std::size_t column) {
    const std::size_t size = picture_.size, x = column * subpixels, y = row * subpixels;
    const auto triangle = [&](std::size_t i) {
      return shown[(y + i / subpixels) * size * subpixels + x + i % subpixels];
    };
    for (std::size_t i = 0; i < samples; ++i)
      if (triangle(i) == none) return;
    pixels_.push_back((band * (Viewfinder::rows / subpixels) + row) * size + column);
    for (std::size_t i = 0; i < samples; ++i)
      spots_.push_back(finder_.spot(triangle(i), x + i % subpixels, band * Viewfinder::rows + y + i / subpixels));
  }

  void light() {
    normals_.resize(spots_.size());
    normals_at_(spots_, normals_);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      float sum = 0;
      for (std::size_t k = 0; k < samples; ++k) sum += lit(normals_[i * samples + k]);
      picture_.light[pixels_[i]] = sum / samples;
    }
  }
  [[nodiscard]] float lit(const Vec3f& normal) const {
    const float cosine = dot(normal, light_), squared_length = squared_norm(normal);
    return cosine > 0 ? 0.1F + 0.9F * cosine / std::sqrt(squared_length) : 0.1F;
  }

  Viewfinder& finder_;
  const NormalsAt& normals_at_;
  Vec3f light_;
  Picture& picture_;
  std::vector<std::size_t> pixels_; // of the band, those that are covered,
  std::vector<Spot> spots_;         // and their subpixels
  std::vector<Vec3f> normals_;
};

} // namespace

NormalsAt interpolated(std::span<const Vec3d> normals, std::span<const mesh::Triangle> triangles) {
  return [=](std::span<const Spot> spots, std::span<Vec3f> out) {
    for (std::size_t i = 0; i < spots.size(); ++i) {
      const auto& [a, b, c] = triangles[spots[i].triangle];
      const double wb = spots[i].b, wc = spots[i].c;
      out[i] = Vec3f(normals[a] * (1 - wb - wc) + normals[b] * wb + normals[c] * wc);
    }
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
  Picture picture{size_, std::vector<float>(std::size_t{size_} * size_, background)};
  Shader shader(finder, sitter.normals_at, from, picture);
  for (std::size_t band = 0; band < finder.bands(); ++band) shader.shade(band);
  return picture;
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
