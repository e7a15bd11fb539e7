#include "core/lod/normal_map.h"

#include <algorithm>
#include <cmath>

#include "core/texture/raster.h"

namespace orbis::lod {
namespace {

constexpr double scale = 127;

} // namespace

NormalMap::NormalMap(const FullSurface& full, std::span<const Vec3d> normals) {
  const texture::CutMesh& cut = full.cut();
  for (const texture::Page& page : cut.pages) {
    pages_.push_back({page.width, page.height, {}});
    pages_.back().texels.resize(std::size_t{page.width} * page.height);
  }
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    Page& page = pages_[cut.page_of(t)];
    std::array<texture::RasterPoint, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f& uv = cut.vertices[cut.triangles[t][k]].uv;
      corners[k] = {double{uv.x} * page.width, double{uv.y} * page.height};
    }
    texture::rasterize(corners, page.width, page.height,
                       [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>& w) {
                         const auto& [a, b, c] = cut.triangles[t];
                         const Vec3d n = normals[a] * w[0] + normals[b] * w[1] + normals[c] * w[2];
                         const double length = norm(n);
                         const double s = length > 0 ? scale / length : 0;
                         page.texels[std::size_t{y} * page.width + x] = {static_cast<std::int8_t>(std::lrint(s * n.x)),
                                                                         static_cast<std::int8_t>(std::lrint(s * n.y)),
                                                                         static_cast<std::int8_t>(std::lrint(s * n.z))};
                       });
  }
  for (Page& page : pages_) spread(page);
}

// One texel further out is all that a bilinear read inside a chart can touch.
void NormalMap::spread(Page& page) {
  const std::vector<Texel> inside = page.texels;
  for (std::uint32_t y = 0; y < page.height; ++y) {
    for (std::uint32_t x = 0; x < page.width; ++x) {
      if (inside[std::size_t{y} * page.width + x] != Texel{}) continue;
      std::array<int, 3> sum{};
      int count = 0;
      for (std::uint32_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, page.height - 1); ++j) {
        for (std::uint32_t i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, page.width - 1); ++i) {
          const Texel& near = inside[std::size_t{j} * page.width + i];
          if (near == Texel{}) continue;
          ++count;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += near[c];
        }
      }
      if (count == 0) continue;
      for (std::size_t c = 0; c < 3; ++c)
        page.texels[std::size_t{y} * page.width + x][c] = static_cast<std::int8_t>(sum[c] / count);
    }
  }
}

Vec3d NormalMap::at(const Uv& uv, std::uint32_t page_number) const {
  const Page& page = pages_[page_number];
  const double x = std::clamp(uv[0] * page.width - 0.5, 0.0, page.width - 1.0);
  const double y = std::clamp(uv[1] * page.height - 0.5, 0.0, page.height - 1.0);
  const auto x0 = static_cast<std::uint32_t>(x), y0 = static_cast<std::uint32_t>(y);
  const std::uint32_t x1 = std::min(x0 + 1, page.width - 1), y1 = std::min(y0 + 1, page.height - 1);
  const auto read = [&](std::uint32_t i, std::uint32_t j) {
    const Texel& t = page.texels[std::size_t{j} * page.width + i];
    return Vec3d(t[0], t[1], t[2]);
  };
  const double s = x - x0, t = y - y0;
  return (read(x0, y0) * (1 - s) + read(x1, y0) * s) * (1 - t) + (read(x0, y1) * (1 - s) + read(x1, y1) * s) * t;
}

NormalsAt NormalMap::on(const texture::CutMesh& level) const {
  return [this, &level](std::span<const Spot> spots, std::span<Vec3f> out) {
    for (std::size_t i = 0; i < spots.size(); ++i) {
      const std::array<double, 3> w{1.0 - spots[i].b - spots[i].c, spots[i].b, spots[i].c};
      Uv uv{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2f& corner = level.vertices[level.triangles[spots[i].triangle][k]].uv;
        uv[0] += w[k] * corner.x;
        uv[1] += w[k] * corner.y;
      }
      out[i] = Vec3f(at(uv, level.page_of(spots[i].triangle)));
    }
  };
}

} // namespace orbis::lod
