#include "core/texture/texel_map.h"

#include <algorithm>

#include "core/texture/bands.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t band_rows = 32; // rasterised by one thread at a time

} // namespace

std::array<double, 3> TriangleInPage::nearest_weights(double x, double y) const {
  const std::array<double, 3> inside = weights(x, y);
  if (inside[0] >= 0 && inside[1] >= 0 && inside[2] >= 0) return inside;
  std::array<double, 3> best{1, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const RasterPoint &a = corners[k], &b = corners[(k + 1) % 3];
    const double ex = b.x - a.x, ey = b.y - a.y, length = ex * ex + ey * ey;
    const double t = length > 0 ? std::clamp(((x - a.x) * ex + (y - a.y) * ey) / length, 0.0, 1.0) : 0.0;
    const double dx = x - (a.x + t * ex), dy = y - (a.y + t * ey), distance = dx * dx + dy * dy;
    if (distance >= least) continue;
    least = distance;
    best = {};
    best[k] = 1 - t;
    best[(k + 1) % 3] = t;
  }
  return best;
}

TexelMap::TexelMap(const PageMesh& mesh, std::uint32_t width, std::uint32_t height, mesh::ThreadPool& pool)
    : mesh_(mesh), width_(width), height_(height), triangle_(std::size_t{width} * height, nothing),
      covered_(triangle_.size(), 0) {
  cover(pool);
  covered_texels_ = static_cast<std::uint64_t>(std::count(covered_.begin(), covered_.end(), std::uint8_t{1}));
  spread();
}

std::array<RasterPoint, 3> TexelMap::corners(std::uint32_t triangle) const {
  std::array<RasterPoint, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2f& uv = mesh_.uv[mesh_.triangles[triangle][k]];
    out[k] = {double{uv.x} * width_, double{uv.y} * height_};
  }
  return out;
}

TriangleInPage TexelMap::place(std::uint32_t triangle) const {
  TriangleInPage out;
  out.corners = corners(triangle);
  const auto& p = out.corners;
  const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  out.at_corner_0 = {1, 0, 0};
  if (area == 0) return out; // it covers no texel; its first corner stands for it
  const double scale = 1 / area;
  for (std::size_t k = 0; k < 3; ++k) {
    const RasterPoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    out.along_x[k] = (a.y - b.y) * scale;
    out.along_y[k] = (b.x - a.x) * scale;
  }
  return out;
}

void TexelMap::find_runs(std::size_t top, std::size_t end, std::vector<Run>& runs) const {
  runs.clear();
  for (std::size_t y = top; y < end; ++y) {
    const std::uint32_t* const row = &triangle_[y * width_];
    for (std::uint32_t x = 0; x < width_;) {
      const std::uint32_t first = x, t = row[x];
      while (x < width_ && row[x] == t) ++x;
      if (t != nothing) runs.emplace_back(t, static_cast<std::uint32_t>(y - top), first, x - 1);
    }
  }
  std::ranges::sort(runs, {}, &Run::bits);
}

void TexelMap::cover(mesh::ThreadPool& pool) {
  const auto corners_of = [this](std::uint32_t t) { return corners(t); };
  const Bands bands(mesh_.shown, height_, band_rows, corners_of);
  pool.for_blocks(bands.count(), 1, [&](std::size_t band, std::size_t) {
    const std::uint32_t top = bands.top(band), rows = bands.rows(band);
    bands.for_each(band, corners_of, [&](std::uint32_t t, const std::array<RasterPoint, 3>& p) {
      rasterize_rows(p, width_, rows, [&](const CoveredRow& row) {
        const std::size_t first = std::size_t{top + row.y} * width_;
        std::fill(&triangle_[first + row.begin], &triangle_[first] + row.end, t);
        std::fill(&covered_[first + row.begin], &covered_[first] + row.end, std::uint8_t{1});
      });
    });
  });
}

// Breadth first from the charts' borders, ring by ring: each ring looks only at the rings before it, in the order of
// the page.
void TexelMap::spread() {
  std::vector<std::size_t> ring;
  const auto for_neighbours = [&](std::size_t texel, auto visit) {
    const std::size_t x = texel % width_, y = texel / width_;
    if (y > 0) visit(texel - width_);
    if (x > 0) visit(texel - 1);
    if (x + 1 < width_) visit(texel + 1);
    if (y + 1 < height_) visit(texel + width_);
  };
  for (std::size_t i = 0; i < triangle_.size(); ++i) {
    if (covered_[i] == 0) continue;
    bool at_border = false;
    for_neighbours(i, [&](std::size_t j) { at_border = at_border || covered_[j] == 0; });
    if (at_border) ring.push_back(i);
  }
  std::vector<std::size_t> next;
  while (!ring.empty()) {
    next.clear();
    for (const std::size_t i : ring) {
      for_neighbours(i, [&](std::size_t j) {
        if (triangle_[j] != nothing) return;
        triangle_[j] = triangle_[i];
        next.push_back(j);
      });
    }
    ring.swap(next);
  }
}

} // namespace orbis::texture
