#include "core/texture/fragments.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/texture/page_raster.h"

namespace orbis::texture {
namespace {

// log2 of the atlas texels along a side of a pixel, from the areas of the triangle in both.
double mip_level_of(const std::array<RasterPoint, 3>& screen, const std::array<RasterPoint, 3>& atlas) {
  const auto area = [](const std::array<RasterPoint, 3>& p) {
    return std::abs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y));
  };
  const double on_screen = area(screen), in_atlas = area(atlas);
  const double texels = on_screen > 0 ? in_atlas / on_screen * subpixels * subpixels : 0;
  return texels > 1 ? 0.5 * std::log2(texels) : 0;
}

Light between_levels(const Sampler& atlas, double x, double y, double level) {
  const double lower = std::min(std::floor(level), BaseColors::mip_levels - 2.0);
  const auto k = static_cast<std::uint32_t>(lower);
  const auto t = static_cast<float>(std::min(level - lower, 1.0));
  Light light = atlas.sample(x, y, k);
  if (t == 0) return light;
  const Light coarse = atlas.sample(x, y, k + 1);
  for (std::size_t c = 0; c < 4; ++c) light[c] = (1 - t) * light[c] + t * coarse[c];
  return light;
}

// Pushes what is farther towards the end, and the farthest out.
void insert(Fragment fragment, Layers& layers) {
  for (Fragment& layer : layers)
    if (fragment.inverse_depth > layer.inverse_depth) std::swap(fragment, layer);
}

// One band while its triangles come in.
class Band {
public:
  Band(std::size_t size, const BaseColors& base_colors) : base_colors_(base_colors) { out_.solid.resize(size); }

  void begin(std::uint32_t triangle, const Material& material) {
    alpha_ = material.alpha;
    if (alpha_.mode != AlphaMode::opaque) base_color_ = base_colors_[triangle];
  }

  [[nodiscard]] bool is_hidden(std::size_t place, float inverse_depth) const {
    return inverse_depth <= out_.solid[place].inverse_depth;
  }

  // One that is not hidden.
  void add(std::size_t place, const Fragment& fragment) {
    Fragment& solid = out_.solid[place];
    if (alpha_.mode == AlphaMode::opaque) {
      solid = fragment;
      return;
    }
    const float alpha = base_color_.at(double{fragment.b}, double{fragment.c})[3];
    constexpr float least = 0.5F / 255; // that a byte can tell
    const bool hides_all = alpha_.mode == AlphaMode::mask ? alpha >= alpha_.cutoff : alpha > 1 - least;
    if (hides_all) {
      solid = fragment;
    } else if (alpha_.mode == AlphaMode::blend && alpha > least) {
      if (out_.layers.empty()) out_.layers.resize(out_.solid.size());
      insert(fragment, out_.layers[place]);
    }
  }

  [[nodiscard]] FragmentRows take() { return std::move(out_); }

private:
  const BaseColors& base_colors_;
  FragmentRows out_;
  Alpha alpha_; // of the triangle that is coming in
  BaseColors::InTriangle base_color_;
};

} // namespace

BaseColors::InTriangle BaseColors::operator[](std::uint32_t triangle) const {
  InTriangle out;
  out.sampler = &samplers_[shape_.mesh.page_of(triangle)];
  out.material = &shape_.material(triangle);
  out.in_page = in_page(shape_.mesh, triangle);
  out.mip_level = mip_level_of(corners_of(shape_.mesh.triangles[triangle], points_), out.in_page);
  return out;
}

Light BaseColors::InTriangle::at(double b, double c) const {
  const auto& [p, q, r] = in_page;
  const double a = 1 - b - c;
  Light light = between_levels(*sampler, a * p.x + b * q.x + c * r.x, a * p.y + b * q.y + c * r.y, mip_level);
  for (std::size_t k = 0; k < 4; ++k) light[k] *= material->factor[k];
  return light;
}

std::vector<std::uint32_t> facing_viewer(const Shape& shape, std::span<const Projected> points) {
  std::vector<std::uint32_t> triangles = all_triangles(shape.mesh.triangles.size());
  std::erase_if(triangles, [&](std::uint32_t t) {
    return !shape.material(t).is_double_sided && is_seen_from_behind(corners_of(shape.mesh.triangles[t], points));
  });
  return triangles;
}

FragmentRows find_visible(const Shape& shape, const Bands& bands, std::size_t band, std::span<const Projected> points,
                          std::uint32_t width, const BaseColors& base_colors) {
  const std::vector<mesh::Triangle>& triangles = shape.mesh.triangles;
  const std::uint32_t rows = bands.rows(band);
  Band out(std::size_t{width} * rows, base_colors);
  const auto corners_in_band = [&](std::uint32_t t) { return corners_of(triangles[t], points); };
  bands.for_each(band, corners_in_band, [&](std::uint32_t t, const std::array<RasterPoint, 3>& corners) {
    out.begin(t, shape.material(t));
    std::array<double, 3> inverse{};
    for (std::size_t k = 0; k < 3; ++k) inverse[k] = points[triangles[t][k]].inverse_depth;
    rasterize(corners, width, rows, [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
      const double depth = weights[0] * inverse[0] + weights[1] * inverse[1] + weights[2] * inverse[2];
      const std::size_t place = std::size_t{y} * width + x;
      if (out.is_hidden(place, static_cast<float>(depth))) return;
      // What is linear in space is linear on the screen after division by the depth.
      out.add(place, {t, static_cast<float>(depth), static_cast<float>(weights[1] * inverse[1] / depth),
                      static_cast<float>(weights[2] * inverse[2] / depth)});
    });
  });
  return out.take();
}

} // namespace orbis::texture
