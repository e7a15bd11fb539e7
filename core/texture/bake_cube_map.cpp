#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/error.h"
#include "core/texture/bake.h"
#include "core/texture/cube_map.h"
#include "core/texture/gutter.h"
#include "core/texture/page_raster.h"
#include "core/texture/sampler.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t report_interval = 1U << 12U; // triangles

// Colours by direction on the sphere.
class Surroundings {
public:
  virtual ~Surroundings() = default;
  // Source texels across `angle` radians at d, in the direction in which there are most.
  [[nodiscard]] virtual double texels_across(const Vec3d& d, double angle) const = 0;
  // d: not zero, need not be normalized.
  [[nodiscard]] virtual Light look(const Vec3d& d, std::uint32_t level) const = 0;
};

// Face coordinates to texels of a face's image.
std::array<double, 2> texel_of(const Image& image, const FacePoint& p) {
  return {0.5 * (p.u + 1) * image.width, 0.5 * (p.v + 1) * image.height};
}

// A face's image with a frame of what lies beyond its border on the neighbours, so that reads across it see no edge.
Image framed(std::span<const Image> images, Face f, std::uint32_t frame) {
  const Image& inner = images[f];
  Image outer{inner.width + 2 * frame, inner.height + 2 * frame, 4, {}};
  outer.pixels.resize(std::size_t{outer.width} * outer.height * outer.channels);
  std::vector<Sampler> samplers;
  for (const Image& image : images) samplers.emplace_back(image, Wrap::clamp, Wrap::clamp, 1);
  for (std::uint32_t y = 0; y < outer.height; ++y)
    for (std::uint32_t x = 0; x < outer.width; ++x) {
      const std::uint32_t column = x - frame, row = y - frame; // wraps around to large numbers outside
      if (column < inner.width && row < inner.height) {
        store(load(inner, column, row), outer, x, y);
        continue;
      }
      const Vec3d beyond =
          direction(f, {2 * (x + 0.5 - frame) / inner.width - 1, 2 * (y + 0.5 - frame) / inner.height - 1});
      const Face g = face_of(beyond);
      const auto [u, v] = texel_of(images[g], project(beyond, g));
      store(samplers[g].sample(u, v, 0), outer, x, y);
    }
  return outer;
}

class CubeFaces final : public Surroundings {
public:
  CubeFaces(std::span<const Image> images, std::uint32_t levels) : images_(images), frame_(1U << levels) {
    framed_.reserve(face_count);
    samplers_.reserve(face_count);
    for (Face f = 0; f < face_count; ++f) {
      framed_.push_back(framed(images, f, frame_));
      samplers_.emplace_back(framed_.back(), Wrap::clamp, Wrap::clamp, levels);
    }
  }

  // The central projection stretches by 1 + u^2 + v^2 at most.
  [[nodiscard]] double texels_across(const Vec3d& d, double angle) const override {
    const Face f = face_of(d);
    const auto [u, v] = project(d, f);
    return 0.5 * std::max(images_[f].width, images_[f].height) * (1 + u * u + v * v) * angle;
  }

  [[nodiscard]] Light look(const Vec3d& d, std::uint32_t level) const override {
    const Face f = face_of(d);
    const auto [x, y] = texel_of(images_[f], project(d, f));
    return samplers_[f].sample(x + frame_, y + frame_, level);
  }

private:
  std::span<const Image> images_;
  std::uint32_t frame_; // texels: two of the coarsest level that is read
  std::vector<Image> framed_;
  std::vector<Sampler> samplers_;
};

class Globe final : public Surroundings {
public:
  Globe(const Image& image, std::uint32_t levels) : image_(image), sampler_(image, Wrap::repeat, Wrap::clamp, levels) {}

  // Away from the poles, where a texel of the globe is a needle that no mip level fits.
  [[nodiscard]] double texels_across(const Vec3d&, double angle) const override {
    return std::max(image_.width / (2 * std::numbers::pi), image_.height / std::numbers::pi) * angle;
  }

  [[nodiscard]] Light look(const Vec3d& d, std::uint32_t level) const override {
    const double longitude = std::atan2(d.x, d.z), latitude = std::atan2(d.y, std::hypot(d.x, d.z));
    return sampler_.sample((0.5 + longitude / (2 * std::numbers::pi)) * image_.width,
                           (0.5 - latitude / std::numbers::pi) * image_.height, level);
  }

private:
  const Image& image_;
  Sampler sampler_;
};

// Mip levels down to images of some sixteen texels.
std::uint32_t level_count(std::span<const Image> images) {
  std::uint32_t smallest = 1U << 16U;
  for (const Image& image : images) smallest = std::min({smallest, image.width, image.height});
  std::uint32_t levels = 1;
  for (; smallest > 16; smallest /= 2) ++levels;
  return levels;
}

// A delivered triangle in the page and on the sphere; both are linear in the barycentric weights.
struct SphereTriangle {
  std::array<RasterPoint, 3> corners;
  std::array<Vec3d, 3> sphere;
  Vec3d along_x, along_y; // how the direction changes from texel to texel

  SphereTriangle(const CutMesh& mesh, std::uint32_t t) : corners(in_page(mesh, t)) {
    const std::array<double, 3> dx = weight_step(corners, 1, 0), dy = weight_step(corners, 0, 1);
    for (std::size_t k = 0; k < 3; ++k) {
      sphere[k] = Vec3d(sphere::from_grid(mesh.vertices[mesh.triangles[t][k]].sphere));
      along_x += sphere[k] * dx[k];
      along_y += sphere[k] * dy[k];
    }
  }

  [[nodiscard]] Vec3d at(const std::array<double, 3>& w) const {
    return sphere[0] * w[0] + sphere[1] * w[1] + sphere[2] * w[2];
  }

  // Radians across a texel around d, in the direction in which there are most.
  [[nodiscard]] double angle(const Vec3d& d) const {
    return std::sqrt(std::max(squared_norm(cross(d, along_x)), squared_norm(cross(d, along_y)))) / squared_norm(d);
  }
};

// The mean over the texel around d.
Light mean(const SphereTriangle& triangle, const Vec3d& d, const Surroundings& surroundings) {
  const Footprint footprint = footprint_of(surroundings.texels_across(d, triangle.angle(d)));
  if (footprint.taps == 1) return surroundings.look(d, footprint.level);
  const double n = footprint.taps;
  Light sum{};
  for (std::uint32_t j = 0; j < footprint.taps; ++j)
    for (std::uint32_t i = 0; i < footprint.taps; ++i) {
      const Light light = surroundings.look(
          d + triangle.along_x * ((i + 0.5) / n - 0.5) + triangle.along_y * ((j + 0.5) / n - 0.5), footprint.level);
      for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
    }
  for (float& c : sum) c /= static_cast<float>(n * n);
  return sum;
}

} // namespace

Image bake_cube_map(const CutMesh& mesh, std::uint32_t page, std::span<const Image> images, Progress& progress) {
  if (images.size() != 1 && images.size() != face_count)
    throw Error(ErrorCode::invalid_option,
                "a cube map is six images (px, nx, py, ny, pz, nz) or one equirectangular image", "texture");
  if (std::any_of(images.begin(), images.end(), [](const Image& i) { return i.width == 0 || i.height == 0; }))
    throw Error(ErrorCode::invalid_option, "an image of the cube map has no pixels", "texture");
  const bool alpha = std::any_of(images.begin(), images.end(), [](const Image& i) { return i.channels == 4; });
  std::unique_ptr<Surroundings> surroundings;
  if (images.size() == 1)
    surroundings = std::make_unique<Globe>(images[0], level_count(images));
  else
    surroundings = std::make_unique<CubeFaces>(images, level_count(images));

  Image image{mesh.pages[page].width, mesh.pages[page].height, alpha ? 4U : 3U, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t) {
    if (t % report_interval == 0) {
      progress.check();
      progress.report(Stage::bake, t, count);
    }
    if (mesh.page_of(t) != page) continue;
    const SphereTriangle triangle(mesh, t);
    rasterize(triangle.corners, image.width, image.height,
              [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
                store(mean(triangle, triangle.at(weights), *surroundings), image, x, y);
              });
  }
  Gutters(mesh, page).fill(image);
  progress.report(Stage::bake, count, count);
  return image;
}

} // namespace orbis::texture
