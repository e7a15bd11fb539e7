#include "core/texture/canvas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/texture/bands.h"
#include "core/texture/page_raster.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t subpixels = 2;  // in each direction
constexpr std::uint32_t band_rows = 16; // pixels, drawn by one thread at a time
constexpr double margin = 0.07;         // of the viewport's smaller side
constexpr std::uint32_t mip_levels = 6;

// The camera's axes: x to the right, y up, z towards the viewer, who stands in front (+Z), 30 degrees to the right and
// 20 degrees up.
const Vec3d view_z = normalized(Vec3d{0.50, 0.42, 0.87});
const Vec3d view_x = normalized(cross(Vec3d{0, 1, 0}, view_z));
const Vec3d view_y = cross(view_z, view_x);

constexpr double eye_distance = 4.2; // radii of the bounding sphere

struct Projected {
  double x = 0, y = 0;      // on the image plane, y down
  double inverse_depth = 0; // 1 / distance from the eye along the view
};

struct Projection {
  std::vector<Projected> points;
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  double x_low = infinity, x_high = -infinity, y_low = infinity, y_high = -infinity;

  // Never 0, so that what is seen edge-on can be scaled too.
  [[nodiscard]] double width() const { return std::max(x_high - x_low, 1e-6); }
  [[nodiscard]] double height() const { return std::max(y_high - y_low, 1e-6); }

  void add(const Projected& p) {
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
    points.push_back(p);
  }
};

// Perspective with the eye at a few radii.
Projection project_all(std::span<const Vec3d> positions) {
  Vec3d low = positions[0], high = positions[0];
  for (const Vec3d& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3d centre = (low + high) * 0.5;
  double radius = 0;
  for (const Vec3d& p : positions) radius = std::max(radius, norm(p - centre));
  Projection projection;
  projection.points.reserve(positions.size());
  for (const Vec3d& p : positions) {
    const Vec3d d = (p - centre) * (1 / radius);
    const double inverse_depth = 1 / (eye_distance - dot(d, view_z));
    projection.add({dot(d, view_x) * inverse_depth, -dot(d, view_y) * inverse_depth, inverse_depth});
  }
  return projection;
}

// Moves and scales the outline so that it fits the viewport, in sub-pixels from the viewport's corner.
std::vector<Projected> fitted(Projection projection, const Viewport& view) {
  const double border = margin * std::min(view.width, view.height);
  const double scale =
      std::min((view.width - 2 * border) / projection.width(), (view.height - 2 * border) / projection.height());
  for (Projected& p : projection.points) {
    p.x = subpixels * (0.5 * view.width + scale * (p.x - 0.5 * (projection.x_low + projection.x_high)));
    p.y = subpixels * (0.5 * view.height + scale * (p.y - 0.5 * (projection.y_low + projection.y_high)));
  }
  return std::move(projection.points);
}

// The triangle that is seen at a sub-pixel.
struct Fragment {
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
  float inverse_depth = 0;
  float b = 0, c = 0; // weights of its second and third corner, in space
};

std::array<RasterPoint, 3> corners_of(const mesh::Triangle& triangle, std::span<const Projected> points) {
  std::array<RasterPoint, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = {points[triangle[k]].x, points[triangle[k]].y};
  return corners;
}

// What is seen at the sub-pixels of a band of rows.
std::vector<Fragment> find_visible(std::span<const mesh::Triangle> triangles, const Bands& bands, std::size_t band,
                                   std::span<const Projected> points, std::uint32_t width) {
  const std::uint32_t rows = bands.rows(band);
  std::vector<Fragment> fragments(std::size_t{width} * rows);
  const auto corners_in_band = [&](std::uint32_t t) { return corners_of(triangles[t], points); };
  bands.for_each(band, corners_in_band, [&](std::uint32_t t, const std::array<RasterPoint, 3>& corners) {
    std::array<double, 3> inverse{};
    for (std::size_t k = 0; k < 3; ++k) inverse[k] = points[triangles[t][k]].inverse_depth;
    rasterize(corners, width, rows, [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
      const double depth = weights[0] * inverse[0] + weights[1] * inverse[1] + weights[2] * inverse[2];
      Fragment& fragment = fragments[std::size_t{y} * width + x];
      if (static_cast<float>(depth) <= fragment.inverse_depth) return;
      // What is linear in space is linear on the screen after division by the depth.
      fragment = {t, static_cast<float>(depth), static_cast<float>(weights[1] * inverse[1] / depth),
                  static_cast<float>(weights[2] * inverse[2] / depth)};
    });
  });
  return fragments;
}

// A warm key light from the upper left, a cool fill light from the right, and sky above ground.
Light shaded(const Light& color, const Vec3d& normal) {
  static const Vec3d key = normalized(view_x * -0.45 + view_y * 0.65 + view_z * 0.75);
  static const Vec3d fill = normalized(view_x * 0.85 + view_y * 0.05 + view_z * 0.45);
  constexpr std::array<double, 3> key_color{0.80, 0.78, 0.74}, fill_color{0.16, 0.18, 0.21};
  const double lit = std::max(dot(normal, key), 0.0), filled = std::max(dot(normal, fill), 0.0);
  const double sky = 0.26 + 0.10 * normal.y;
  static const Vec3d halfway = normalized(key + view_z);
  const double at_halfway = std::max(dot(normal, halfway), 0.0), power_8 = std::pow(at_halfway, 8);
  const double gloss = 0.10 * power_8 * power_8 * power_8 * power_8 * power_8;
  Light result{0, 0, 0, 1};
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = static_cast<float>(color[c] * (sky + lit * key_color[c] + filled * fill_color[c]) + gloss);
  return result;
}

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
  const double lower = std::min(std::floor(level), mip_levels - 2.0);
  const auto k = static_cast<std::uint32_t>(lower);
  const auto t = static_cast<float>(std::min(level - lower, 1.0));
  Light light = atlas.sample(x, y, k);
  if (t == 0) return light;
  const Light coarse = atlas.sample(x, y, k + 1);
  for (std::size_t c = 0; c < 4; ++c) light[c] = (1 - t) * light[c] + t * coarse[c];
  return light;
}

// Shades what is seen of a shape, pixel by pixel.
class Shading {
public:
  Shading(const Shape& shape, std::span<const Projected> points, std::span<const Sampler> samplers)
      : shape_(shape), points_(points), samplers_(samplers) {}

  // The mean over a pixel's sub-pixels, those that show nothing counting as `behind`.
  [[nodiscard]] Light pixel(const std::array<Fragment, subpixels * subpixels>& fragments, const Light& behind) const {
    std::array<bool, subpixels * subpixels> done{};
    Light sum{};
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (done[i]) continue;
      // All sub-pixels of one triangle at once, at their middle.
      double b = 0, c = 0;
      float count = 0;
      for (std::size_t j = i; j < fragments.size(); ++j) {
        if (fragments[j].triangle != fragments[i].triangle) continue;
        done[j] = true;
        count += 1;
        b += double{fragments[j].b};
        c += double{fragments[j].c};
      }
      const Light light =
          fragments[i].inverse_depth == 0 ? behind : at(fragments[i].triangle, b / double{count}, c / double{count});
      for (std::size_t k = 0; k < 3; ++k) sum[k] += count * light[k] / (subpixels * subpixels);
    }
    return sum;
  }

private:
  const Shape& shape_;
  std::span<const Projected> points_;
  std::span<const Sampler> samplers_;

  [[nodiscard]] Light at(std::uint32_t t, double b, double c) const {
    const mesh::Triangle& triangle = shape_.mesh.triangles[t];
    const std::array<double, 3> weights{1 - b - c, b, c};
    const std::array<RasterPoint, 3> in_atlas = in_page(shape_.mesh, t);
    RasterPoint place;
    Vec3d normal;
    for (std::size_t k = 0; k < 3; ++k) {
      place.x += weights[k] * in_atlas[k].x;
      place.y += weights[k] * in_atlas[k].y;
      normal += shape_.normals[triangle[k]] * weights[k];
    }
    // A model that is inside out still shows its surface to the viewer.
    const double facing = dot(normal, view_z) < 0 ? -1 : 1;
    const double length = norm(normal);
    normal = length > 0 ? normal * (facing / length) : view_z;
    const double level = mip_level_of(corners_of(triangle, points_), in_atlas);
    Light color = between_levels(samplers_[shape_.mesh.page_of(t)], place.x, place.y, level);
    for (std::size_t k = 0; k < 3 && !shape_.tints.empty(); ++k) color[k] *= shape_.tints[t][k];
    return shaded(color, normal);
  }
};

} // namespace

std::vector<Vec3d> smooth_normals(const CutMesh& mesh, std::span<const Vec3d> positions) {
  std::vector<Vec3d> at_point(mesh.points);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d area = cross(positions[b] - positions[a], positions[c] - positions[a]);
    for (const mesh::Index v : {a, b, c}) at_point[mesh.vertices[v].point] += area;
  }
  std::vector<Vec3d> normals;
  normals.reserve(mesh.vertices.size());
  for (const CutVertex& v : mesh.vertices) {
    const double length = norm(at_point[v.point]);
    normals.push_back(length > 0 ? at_point[v.point] * (1 / length) : Vec3d{0, 0, 1});
  }
  return normals;
}

Canvas::Canvas(std::uint32_t width, std::uint32_t height, std::span<const Image> pages, mesh::ThreadPool& pool)
    : width_(width), height_(height), pool_(pool), lights_(std::size_t{width} * height) {
  for (const Image& page : pages) samplers_.emplace_back(page, Wrap::clamp, Wrap::clamp, mip_levels);
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
  const std::vector<Projected> points = fitted(project_all(shape.positions), view);
  const auto& triangles = shape.mesh.triangles;
  const Bands bands(all_triangles(triangles.size()), subpixels * view.height, subpixels * band_rows,
                    [&](std::uint32_t t) { return corners_of(triangles[t], points); });
  const Shading shading(shape, points, samplers_);
  pool_.for_blocks(bands.count(), 1, [&](std::size_t band, std::size_t) {
    const std::uint32_t width = subpixels * view.width;
    const std::uint32_t top = bands.top(band) / subpixels, rows = bands.rows(band) / subpixels; // pixels
    const std::vector<Fragment> fragments = find_visible(triangles, bands, band, points, width);
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < view.width; ++x) {
        std::array<Fragment, subpixels * subpixels> here;
        for (std::size_t i = 0; i < here.size(); ++i)
          here[i] = fragments[(subpixels * y + i / subpixels) * width + subpixels * x + i % subpixels];
        Light& light = lights_[std::size_t{view.y + top + y} * width_ + view.x + x];
        light = shading.pixel(here, light);
      }
  });
}

double aspect_of(const Shape& shape) {
  const Projection projection = project_all(shape.positions);
  return projection.width() / projection.height();
}

Image Canvas::picture() const {
  Image image{width_, height_, 3, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  for (std::uint32_t y = 0; y < height_; ++y)
    for (std::uint32_t x = 0; x < width_; ++x) store(lights_[std::size_t{y} * width_ + x], image, x, y);
  return image;
}

} // namespace orbis::texture
