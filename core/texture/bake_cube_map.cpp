#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/texture/bake.h"
#include "core/texture/cube_map.h"
#include "core/texture/sampler.h"
#include "core/texture/shade.h"

namespace orbis::texture {
namespace {

// Face coordinates to texels of a face's image.
std::array<double, 2> texel_of(const Image& image, const FacePoint& p) {
  return {0.5 * (p.u + 1) * image.width, 0.5 * (p.v + 1) * image.height};
}

// A face's image with a frame of what lies beyond its border on the neighbours, so that reads across it see no edge.
Image framed(std::span<const Image> images, std::span<const Sampler> samplers, Face f, std::uint32_t frame) {
  const Image& inner = images[f];
  Image outer{inner.width + 2 * frame, inner.height + 2 * frame, inner.channels, {}};
  outer.pixels.resize(std::size_t{outer.width} * outer.height * outer.channels);
  const auto beyond = [&](std::uint32_t x, std::uint32_t y) {
    const Vec3d d = direction(f, {2 * (x + 0.5 - frame) / inner.width - 1, 2 * (y + 0.5 - frame) / inner.height - 1});
    const Face g = face_of(d);
    const auto [u, v] = texel_of(images[g], project(d, g));
    store(samplers[g].sample(u, v, 0), outer, x, y);
  };
  for (std::uint32_t y = 0; y < outer.height; ++y) {
    const bool crosses = y >= frame && y < frame + inner.height;
    const std::uint32_t left_end = crosses ? frame : outer.width;
    for (std::uint32_t x = 0; x < left_end; ++x) beyond(x, y);
    if (!crosses) continue;
    std::copy_n(inner.at(0, y - frame), std::size_t{inner.width} * inner.channels, outer.at(frame, y));
    for (std::uint32_t x = frame + inner.width; x < outer.width; ++x) beyond(x, y);
  }
  return outer;
}

// Colours by direction on the sphere: six images.
class CubeFaces {
public:
  explicit CubeFaces(std::span<const Image> images) : images_(images) {}

  // Makes the mip levels up to this number, and what look() needs around each face.
  void prepare(std::uint32_t levels) {
    frame_ = 1U << levels;
    std::vector<Sampler> inner;
    for (const Image& image : images_) inner.emplace_back(image, Wrap::clamp, Wrap::clamp, 1);
    framed_.reserve(face_count);
    for (Face f = 0; f < face_count; ++f) {
      framed_.push_back(framed(images_, inner, f, frame_));
      samplers_.emplace_back(framed_.back(), Wrap::clamp, Wrap::clamp, levels);
    }
  }

  // Where a direction (not zero, need not be normalized) lies.
  struct Place {
    Face face;
    FacePoint at;
  };
  [[nodiscard]] static Place place(const Vec3d& d) {
    const Face f = face_of(d);
    return {f, project(d, f)};
  }

  // Source texels across `angle` radians, in the direction in which there are most: the central projection stretches by
  // 1 + u^2 + v^2 at most.
  [[nodiscard]] double texels_across(const Place& p, double angle) const {
    const Image& image = images_[p.face];
    return 0.5 * std::max(image.width, image.height) * (1 + p.at.u * p.at.u + p.at.v * p.at.v) * angle;
  }

  [[nodiscard]] Light look(const Place& p, std::uint32_t level) const {
    const auto [x, y] = texel_of(images_[p.face], p.at);
    return samplers_[p.face].sample(x + frame_, y + frame_, level);
  }

private:
  std::span<const Image> images_;
  std::uint32_t frame_ = 0; // texels: two of the coarsest level that is read
  std::vector<Image> framed_;
  std::vector<Sampler> samplers_;
};

// One image of all directions, with the same members.
class Globe {
public:
  explicit Globe(const Image& image) : image_(image), sampler_(image, Wrap::repeat, Wrap::clamp, 1) {}

  void prepare(std::uint32_t levels) { sampler_ = Sampler(image_, Wrap::repeat, Wrap::clamp, levels); }

  struct Place {
    double longitude, latitude;
  };
  [[nodiscard]] static Place place(const Vec3d& d) {
    return {std::atan2(d.x, d.z), std::atan2(d.y, std::sqrt(d.x * d.x + d.z * d.z))};
  }

  // Away from the poles, where a texel of the globe is a needle that no mip level fits.
  [[nodiscard]] double texels_across(const Place&, double angle) const {
    return std::max(image_.width / (2 * std::numbers::pi), image_.height / std::numbers::pi) * angle;
  }

  [[nodiscard]] Light look(const Place& p, std::uint32_t level) const {
    return sampler_.sample((0.5 + p.longitude / (2 * std::numbers::pi)) * image_.width,
                           (0.5 - p.latitude / std::numbers::pi) * image_.height, level);
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
  std::array<Vec3d, 3> sphere;
  Vec3d along_x, along_y; // how the direction changes from texel to texel

  SphereTriangle() = default;
  SphereTriangle(const CutMesh& mesh, std::uint32_t t, const TriangleInPage& place) {
    for (std::size_t k = 0; k < 3; ++k) {
      sphere[k] = Vec3d(sphere::from_grid(mesh.vertices[mesh.triangles[t][k]].sphere));
      along_x += sphere[k] * place.along_x[k];
      along_y += sphere[k] * place.along_y[k];
    }
  }

  [[nodiscard]] Vec3d at(const std::array<double, 3>& w) const {
    return sphere[0] * w[0] + sphere[1] * w[1] + sphere[2] * w[2];
  }

  // Whether the three directions lie within a few degrees: then one footprint does for all of it.
  [[nodiscard]] bool is_small() const {
    constexpr double few = 0.1; // radians
    const auto is_short = [](const Vec3d& edge) { return squared_norm(edge) < few * few; };
    return is_short(sphere[1] - sphere[0]) && is_short(sphere[2] - sphere[1]) && is_short(sphere[0] - sphere[2]);
  }

  // Radians across a texel around d, in the direction in which there are most.
  [[nodiscard]] double angle(const Vec3d& d) const {
    return std::sqrt(std::max(squared_norm(cross(d, along_x)), squared_norm(cross(d, along_y)))) / squared_norm(d);
  }
};

template <class Surroundings> class SurroundingsShader {
public:
  SurroundingsShader(const CutMesh& mesh, const Surroundings& surroundings, Image& image)
      : mesh_(mesh), surroundings_(surroundings), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage& place) {
    triangle_ = {mesh_, t, place};
    is_small_ = triangle_.is_small();
    if (is_small_) footprint_ = footprint_at(triangle_.at({1.0 / 3, 1.0 / 3, 1.0 / 3}));
  }

  void texel(std::uint32_t x, std::uint32_t y, const std::array<double, 3>& weights) {
    const Vec3d d = triangle_.at(weights);
    store(mean(d, is_small_ ? footprint_ : footprint_at(d)), image_, x, y);
  }

private:
  [[nodiscard]] Footprint footprint_at(const Vec3d& d) const {
    return footprint_of(surroundings_.texels_across(surroundings_.place(d), triangle_.angle(d)));
  }

  // Over the texel around d.
  [[nodiscard]] Light mean(const Vec3d& d, const Footprint& footprint) const {
    const auto place = surroundings_.place(d);
    if (footprint.taps == 1) return surroundings_.look(place, footprint.level);
    const double n = footprint.taps;
    Light sum{};
    for (std::uint32_t j = 0; j < footprint.taps; ++j)
      for (std::uint32_t i = 0; i < footprint.taps; ++i) {
        const Vec3d tap = d + triangle_.along_x * ((i + 0.5) / n - 0.5) + triangle_.along_y * ((j + 0.5) / n - 0.5);
        const Light light = surroundings_.look(surroundings_.place(tap), footprint.level);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
      }
    for (float& c : sum) c /= static_cast<float>(n * n);
    return sum;
  }

  const CutMesh& mesh_;
  const Surroundings& surroundings_;
  Image& image_;
  SphereTriangle triangle_;
  bool is_small_ = false;
  Footprint footprint_; // of a small triangle
};

// The mip levels that the page's triangles read, by their corners.
template <class Surroundings>
std::uint32_t levels_read(const TexelMap& map, const CutMesh& mesh, const Surroundings& surroundings) {
  std::uint32_t levels = 1;
  for (const std::uint32_t t : map.shown()) {
    const SphereTriangle triangle(mesh, t, map.place(t));
    for (const Vec3d& d : triangle.sphere)
      levels = std::max(levels,
                        footprint_of(surroundings.texels_across(surroundings.place(d), triangle.angle(d))).level + 1);
  }
  return levels;
}

template <class Surroundings>
void bake(const TexelMap& map, const CutMesh& mesh, Surroundings surroundings, std::uint32_t most_levels, Image& image,
          const Progress& progress, mesh::ThreadPool& pool) {
  surroundings.prepare(std::min(levels_read(map, mesh, surroundings), most_levels));
  shade(map, pool, progress, [&] { return SurroundingsShader<Surroundings>(mesh, surroundings, image); });
}

} // namespace

Image bake_cube_map(const TexelMap& map, const CutMesh& mesh, std::span<const Image> images, const Progress& progress,
                    mesh::ThreadPool& pool) {
  if (images.size() != 1 && images.size() != face_count)
    throw Error(ErrorCode::invalid_option,
                "a cube map is six images (px, nx, py, ny, pz, nz) or one equirectangular image", "texture");
  if (std::any_of(images.begin(), images.end(), [](const Image& i) { return i.width == 0 || i.height == 0; }))
    throw Error(ErrorCode::invalid_option, "an image of the cube map has no pixels", "texture");
  const bool alpha = std::any_of(images.begin(), images.end(), [](const Image& i) { return i.channels == 4; });
  Image image{map.width(), map.height(), alpha ? 4U : 3U, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  if (images.size() == 1)
    bake(map, mesh, Globe(images[0]), level_count(images), image, progress, pool);
  else
    bake(map, mesh, CubeFaces(images), level_count(images), image, progress, pool);
  return image;
}

} // namespace orbis::texture
