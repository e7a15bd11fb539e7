#include "core/texture/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/texture/bands.h"
#include "core/texture/fragments.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t band_rows = 16; // pixels, drawn by one thread at a time
constexpr std::size_t samples = std::size_t{subpixels} * subpixels;

// A warm key light from the upper left, a cool fill light from the right, and sky above ground. Keeps the alpha.
Light shaded(const Light& color, const Vec3d& normal) {
  static const Vec3d key = normalized(view_x * -0.45 + view_y * 0.65 + view_z * 0.75);
  static const Vec3d fill = normalized(view_x * 0.85 + view_y * 0.05 + view_z * 0.45);
  constexpr std::array<double, 3> key_color{0.80, 0.78, 0.74}, fill_color{0.16, 0.18, 0.21};
  const double lit = std::max(dot(normal, key), 0.0), filled = std::max(dot(normal, fill), 0.0);
  const double sky = 0.26 + 0.10 * normal.y;
  static const Vec3d halfway = normalized(key + view_z);
  const double at_halfway = std::max(dot(normal, halfway), 0.0);
  const double power_2 = at_halfway * at_halfway, power_4 = power_2 * power_2, power_8 = power_4 * power_4;
  const double gloss = 0.10 * power_8 * power_8 * power_8 * power_8 * power_8;
  Light result = color;
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = static_cast<float>(color[c] * (sky + lit * key_color[c] + filled * fill_color[c]) + gloss);
  return result;
}

// The sub-pixels of a pixel: what hides all behind it, and the layers that shine through; null: none.
struct Pixel {
  std::array<const Fragment*, samples> solid{};
  std::array<const Layers*, samples> layers{};

  // x, y: in the band, width: of the viewport; in pixels.
  Pixel(const FragmentRows& rows, std::uint32_t x, std::uint32_t y, std::uint32_t width) {
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t place =
          (subpixels * y + i / subpixels) * std::size_t{subpixels} * width + subpixels * x + i % subpixels;
      solid[i] = &rows.solid[place];
      if (!rows.layers.empty() && rows.layers[place].front().inverse_depth > 0) layers[i] = &rows.layers[place];
    }
  }
};

// Shades what is seen of a shape, pixel by pixel.
class Shading {
public:
  Shading(const Shape& shape, std::span<const Projected> points, const BaseColors& base_colors)
      : shape_(shape), points_(points), base_colors_(base_colors) {}

  // The mean over a pixel's sub-pixels, those that show nothing counting as `behind`.
  [[nodiscard]] Light pixel(const Pixel& pixel, const Light& behind) const {
    std::array<Light, samples> lights = solid_lights(pixel, behind);
    Light sum{};
    for (std::size_t i = 0; i < samples; ++i) {
      if (pixel.layers[i] != nullptr) lay_over(lights[i], *pixel.layers[i], pixel.solid[i]->inverse_depth);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += lights[i][k] / samples;
    }
    return sum;
  }

private:
  const Shape& shape_;
  std::span<const Projected> points_;
  const BaseColors& base_colors_;

  // All sub-pixels of one triangle at once, at their middle.
  [[nodiscard]] std::array<Light, samples> solid_lights(const Pixel& pixel, const Light& behind) const {
    std::array<Light, samples> lights;
    std::array<bool, samples> done{};
    for (std::size_t i = 0; i < samples; ++i) {
      if (done[i]) continue;
      const Fragment& first = *pixel.solid[i];
      double b = 0, c = 0, count = 0;
      for (std::size_t j = i; j < samples; ++j) {
        if (pixel.solid[j]->triangle != first.triangle) continue;
        count += 1;
        b += double{pixel.solid[j]->b};
        c += double{pixel.solid[j]->c};
      }
      const Light light = first.inverse_depth == 0 ? behind : at(first.triangle, b / count, c / count);
      for (std::size_t j = i; j < samples; ++j) {
        if (pixel.solid[j]->triangle != first.triangle) continue;
        done[j] = true;
        lights[j] = light;
      }
    }
    return lights;
  }

  void lay_over(Light& light, const Layers& layers, float solid_inverse_depth) const {
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
      if (layer->inverse_depth <= solid_inverse_depth) continue;
      const Light color = at(layer->triangle, double{layer->b}, double{layer->c});
      for (std::size_t k = 0; k < 3; ++k) light[k] += color[3] * (color[k] - light[k]);
    }
  }

  [[nodiscard]] Light at(std::uint32_t t, double b, double c) const {
    const BaseColors::InTriangle base_color = base_colors_[t];
    return shaded(base_color.at(b, c), base_color.material->is_flat ? flat_normal(t) : smooth_normal(t, b, c));
  }

  [[nodiscard]] Vec3d smooth_normal(std::uint32_t t, double b, double c) const {
    const auto& [i, j, k] = shape_.mesh.triangles[t];
    const Vec3d normal = shape_.normals[i] * (1 - b - c) + shape_.normals[j] * b + shape_.normals[k] * c;
    // A model that is inside out still shows its surface to the viewer.
    const double facing = dot(normal, view_z) < 0 ? -1 : 1;
    const double length = norm(normal);
    return length > 0 ? normal * (facing / length) : view_z;
  }

  // Of the side that is seen.
  [[nodiscard]] Vec3d flat_normal(std::uint32_t t) const {
    const mesh::Triangle& triangle = shape_.mesh.triangles[t];
    const Vec3d& p = shape_.positions[triangle[0]];
    const Vec3d normal = cross(shape_.positions[triangle[1]] - p, shape_.positions[triangle[2]] - p);
    const double facing = is_seen_from_behind(corners_of(triangle, points_)) ? -1 : 1;
    const double length = norm(normal);
    return length > 0 ? normal * (facing / length) : view_z;
  }
};

} // namespace

Canvas::Canvas(std::uint32_t width, std::uint32_t height, std::span<const Image> pages, mesh::ThreadPool& pool)
    : width_(width), height_(height), pool_(pool), lights_(std::size_t{width} * height) {
  for (const Image& page : pages) samplers_.emplace_back(page, Wrap::clamp, Wrap::clamp, BaseColors::mip_levels);
  paint_background();
}

// A studio's backdrop: light, a little darker towards the edges and the floor.
void Canvas::paint_background() {
  for (std::uint32_t y = 0; y < height_; ++y)
    for (std::uint32_t x = 0; x < width_; ++x) {
      const double u = (x + 0.5) / width_ - 0.5, v = (y + 0.5) / height_ - 0.42;
      const auto bright = static_cast<float>(0.86 - 0.45 * (u * u + v * v) - 0.08 * v);
      lights_[std::size_t{y} * width_ + x] = {0.985F * bright, bright, 1.02F * bright, 1};
    }
}

void Canvas::draw(const Shape& shape, const Viewport& view) {
  const std::vector<Projected> points = projected(shape.positions, view);
  const auto& triangles = shape.mesh.triangles;
  const Bands bands(facing_viewer(shape, points), subpixels * view.height, subpixels * band_rows,
                    [&](std::uint32_t t) { return corners_of(triangles[t], points); });
  const BaseColors base_colors(shape, points, samplers_);
  const Shading shading(shape, points, base_colors);
  pool_.for_blocks(bands.count(), 1, [&](std::size_t band, std::size_t) {
    const std::uint32_t top = bands.top(band) / subpixels, rows = bands.rows(band) / subpixels; // pixels
    const FragmentRows seen = find_visible(shape, bands, band, points, subpixels * view.width, base_colors);
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < view.width; ++x) {
        Light& light = lights_[std::size_t{view.y + top + y} * width_ + view.x + x];
        light = shading.pixel(Pixel(seen, x, y, view.width), light);
      }
  });
}

Image Canvas::picture() const {
  Image image{width_, height_, 3, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  for (std::uint32_t y = 0; y < height_; ++y)
    for (std::uint32_t x = 0; x < width_; ++x) store(lights_[std::size_t{y} * width_ + x], image, x, y);
  return image;
}

} // namespace orbis::texture
