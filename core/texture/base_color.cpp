#include <algorithm>
#include <cmath>

#include "core/texture/bake.h"
#include "core/texture/gutter.h"
#include "core/texture/page_raster.h"
#include "core/texture/sampler.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t report_interval = 1U << 12U;

struct TexturedTriangle {
  std::array<RasterPoint, 3> atlas;  // texels of the atlas
  std::array<RasterPoint, 3> source; // texels of the source image
};

// The longer of the two steps in the source that one step in the atlas makes, in texels.
double source_texels_per_texel(const TexturedTriangle& t) {
  const auto difference = [](const RasterPoint& a, const RasterPoint& b) { return RasterPoint{a.x - b.x, a.y - b.y}; };
  const RasterPoint p = difference(t.atlas[1], t.atlas[0]), q = difference(t.atlas[2], t.atlas[0]);
  const RasterPoint s = difference(t.source[1], t.source[0]), r = difference(t.source[2], t.source[0]);
  const double area = p.x * q.y - p.y * q.x;
  if (area == 0) return 0;
  // The source position is linear: its derivatives solve two 2 x 2 systems (Cramer).
  const double along_x = std::hypot(s.x * q.y - r.x * p.y, s.y * q.y - r.y * p.y);
  const double along_y = std::hypot(r.x * p.x - s.x * q.x, r.y * p.x - s.y * q.x);
  return std::max(along_x, along_y) / std::abs(area);
}

class Baker {
public:
  Baker(const CutMesh& mesh, std::uint32_t page, std::span<const Vec2f> uv, std::span<const std::uint32_t> source_of,
        std::span<const BaseColorSource> sources)
      : mesh_(mesh), page_(page), uv_(uv), source_of_(source_of), sources_(sources) {
    const bool alpha = std::any_of(sources.begin(), sources.end(), [](const BaseColorSource& s) {
      return s.image != nullptr ? s.image->channels == 4 : s.color[3] < 1;
    });
    image_ = {mesh.pages[page].width, mesh.pages[page].height, alpha ? 4U : 3U, {}};
    image_.pixels.resize(std::size_t{image_.width} * image_.height * image_.channels);
    make_samplers();
  }

  Image run(Progress& progress) {
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t) {
      if (t % report_interval == 0) {
        progress.check();
        progress.report(Stage::bake, t, count);
      }
      if (mesh_.page_of(t) != page_) continue;
      const std::uint32_t source = source_of_[mesh_.parent[t]];
      if (sources_[source].image == nullptr)
        fill(t, sources_[source].color);
      else
        resample(t, source);
    }
    Gutters(mesh_, page_).fill(image_);
    progress.report(Stage::bake, count, count);
    return std::move(image_);
  }

private:
  const CutMesh& mesh_;
  std::uint32_t page_;
  std::span<const Vec2f> uv_;
  std::span<const std::uint32_t> source_of_;
  std::span<const BaseColorSource> sources_;
  std::vector<Sampler> samplers_; // one per source; without an image one that is never read
  Image image_;

  // Mip levels are made only as far as some triangle reads them.
  void make_samplers() {
    std::vector<std::uint32_t> levels(sources_.size(), 1);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::uint32_t source = source_of_[mesh_.parent[t]];
      if (mesh_.page_of(t) != page_ || sources_[source].image == nullptr) continue;
      const Footprint footprint = footprint_of(source_texels_per_texel(textured(t, source)));
      levels[source] = std::max(levels[source], footprint.level + 1);
    }
    static const Image nothing{1, 1, 3, {0, 0, 0}};
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const BaseColorSource& s = sources_[i];
      samplers_.emplace_back(s.image != nullptr ? *s.image : nothing, s.wrap_u, s.wrap_v, levels[i]);
    }
  }

  [[nodiscard]] TexturedTriangle textured(std::uint32_t t, std::uint32_t source) const {
    const BaseColorSource& s = sources_[source];
    const auto& m = s.transform;
    TexturedTriangle triangle{in_page(mesh_, t), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f& uv = uv_[mesh_.triangles[t][k]];
      triangle.source[k] = {(double{m[0]} * uv.x + double{m[1]} * uv.y + m[2]) * s.image->width,
                            (double{m[3]} * uv.x + double{m[4]} * uv.y + m[5]) * s.image->height};
    }
    return triangle;
  }

  void fill(std::uint32_t t, const std::array<float, 4>& color) {
    rasterize(in_page(mesh_, t), image_.width, image_.height,
              [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>&) { store(color, image_, x, y); });
  }

  void resample(std::uint32_t t, std::uint32_t source) {
    const TexturedTriangle triangle = textured(t, source);
    const Footprint footprint = footprint_of(source_texels_per_texel(triangle));
    rasterize(triangle.atlas, image_.width, image_.height,
              [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
                store(mean(triangle, weights, footprint, samplers_[source]), image_, x, y);
              });
  }

  // The mean over the texel, by taps x taps reads.
  static Light mean(const TexturedTriangle& t, const std::array<double, 3>& centre, const Footprint& footprint,
                    const Sampler& sampler) {
    if (footprint.taps == 1) return read(t, centre, footprint.level, sampler);
    const std::array<double, 3> dx = weight_step(t.atlas, 1, 0), dy = weight_step(t.atlas, 0, 1);
    const double n = footprint.taps;
    Light sum{};
    for (std::uint32_t j = 0; j < footprint.taps; ++j)
      for (std::uint32_t i = 0; i < footprint.taps; ++i) {
        std::array<double, 3> weights = centre;
        double total = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          // Inside the triangle only: beyond a seam of the input's own atlas lies something else.
          weights[k] = std::max(weights[k] + ((i + 0.5) / n - 0.5) * dx[k] + ((j + 0.5) / n - 0.5) * dy[k], 0.0);
          total += weights[k];
        }
        for (double& weight : weights) weight /= total;
        const Light light = read(t, weights, footprint.level, sampler);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
      }
    for (float& c : sum) c /= static_cast<float>(n * n);
    return sum;
  }

  static Light read(const TexturedTriangle& t, const std::array<double, 3>& weights, std::uint32_t level,
                    const Sampler& sampler) {
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x += weights[k] * t.source[k].x;
      y += weights[k] * t.source[k].y;
    }
    return sampler.sample(x, y, level);
  }
};

} // namespace

Image bake_base_color(const CutMesh& mesh, std::uint32_t page, std::span<const Vec2f> uv,
                      std::span<const std::uint32_t> source_of, std::span<const BaseColorSource> sources,
                      Progress& progress) {
  return Baker(mesh, page, uv, source_of, sources).run(progress);
}

} // namespace orbis::texture
