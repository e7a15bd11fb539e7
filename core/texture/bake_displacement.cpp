#include "core/texture/bake_displacement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/texture/shade.h"

namespace orbis::texture {
namespace {

using Weights = std::array<double, 3>;

Vec3d blend(const std::array<Vec3d, 3>& corners, const Weights& w) {
  return corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
}

// The coarse surface's point and unit normal at a texel of the page. Texels come row by row, so the triangle is
// usually the last one.
class CoarsePoint {
public:
  explicit CoarsePoint(const CoarseSurface& coarse) : coarse_(coarse) {}

  // False where no triangle of the chart is there.
  bool find(std::uint32_t x, std::uint32_t y, std::uint32_t chart) {
    const std::uint32_t t = coarse_.map->triangle(x, y);
    if (t == TexelMap::nothing || coarse_.mesh->chart[t] != chart) return false;
    if (t != triangle_) take(t);
    const Weights w =
        coarse_.map->covered(x, y) ? place_.weights(x + 0.5, y + 0.5) : place_.nearest_weights(x + 0.5, y + 0.5);
    position = blend(positions_, w);
    normal = blend(normals_, w);
    if (norm(normal) == 0) normal = own_;
    const double length = norm(normal);
    normal = length > 0 ? normal * (1 / length) : Vec3d{};
    return true;
  }

  Vec3d position, normal;

private:
  void take(std::uint32_t t) {
    triangle_ = t;
    place_ = coarse_.map->place(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const mesh::Index v = coarse_.mesh->triangles[t][k];
      positions_[k] = Vec3d(coarse_.positions[v]);
      normals_[k] = Vec3d(coarse_.normals[v]);
    }
    own_ = cross(positions_[1] - positions_[0], positions_[2] - positions_[0]);
  }

  const CoarseSurface& coarse_;
  std::uint32_t triangle_ = TexelMap::nothing;
  TriangleInPage place_;
  std::array<Vec3d, 3> positions_, normals_;
  Vec3d own_;
};

class DistanceShader {
public:
  DistanceShader(std::span<const std::array<Vec3f, 3>> positions, std::span<const std::uint32_t> chart_of,
                 const CoarseSurface& coarse, std::uint32_t width, std::vector<float>& out)
      : positions_(positions), chart_of_(chart_of), coarse_(coarse), width_(width), out_(out) {}

  void triangle(std::uint32_t t, const TriangleInPage&) {
    triangle_ = t;
    const auto& [a, b, c] = positions_[t];
    corners_ = {Vec3d(a), Vec3d(b), Vec3d(c)};
  }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    if (!coarse_.find(x, y, chart_of_[triangle_])) return;
    out_[std::size_t{y} * width_ + x] = static_cast<float>(dot(blend(corners_, w) - coarse_.position, coarse_.normal));
  }

private:
  std::span<const std::array<Vec3f, 3>> positions_;
  std::span<const std::uint32_t> chart_of_;
  CoarsePoint coarse_;
  std::uint32_t width_;
  std::vector<float>& out_;
  std::uint32_t triangle_ = 0;
  std::array<Vec3d, 3> corners_;
};

} // namespace

Displacement bake_displacement(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions,
                               std::span<const std::uint32_t> chart_of, const CoarseSurface& coarse,
                               const Progress& progress, mesh::ThreadPool& pool) {
  std::vector<float> distances(std::size_t{map.width()} * map.height());
  shade(map, pool, progress, [&] { return DistanceShader(positions, chart_of, coarse, map.width(), distances); });
  Displacement out{{map.width(), map.height(), 1, {}}, 0, 0};
  out.image.pixels.resize(distances.size());
  if (distances.empty()) return out;
  const auto [low, high] = std::minmax_element(distances.begin(), distances.end());
  out.offset = double{*low};
  out.scale = double{*high} - out.offset;
  constexpr double most = std::numeric_limits<std::uint16_t>::max();
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double n = out.scale > 0 ? (double{distances[i]} - out.offset) / out.scale : 0;
    out.image.pixels[i] = static_cast<std::uint16_t>(std::lround(most * n));
  }
  return out;
}

} // namespace orbis::texture
