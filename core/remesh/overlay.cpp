#include "core/remesh/overlay.h"

#include <algorithm>

#include "core/remesh/sphere_tree.h"

namespace orbis::remesh {
namespace {

constexpr std::size_t grain = 256;     // target triangles a block
constexpr double smallest_area = 1e-9; // of a part, in its target triangle's: no texel shows it

OverlayCorner between(const OverlayCorner& a, const OverlayCorner& b, double t) {
  OverlayCorner out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.on_source[k] = (1 - t) * a.on_source[k] + t * b.on_source[k];
    out.on_target[k] = (1 - t) * a.on_target[k] + t * b.on_target[k];
  }
  return out;
}

// What lies on the inner side of the target's edge across from corner k.
std::vector<OverlayCorner> clipped(const std::vector<OverlayCorner>& polygon, std::size_t k) {
  std::vector<OverlayCorner> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const OverlayCorner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = a.on_target[k], at_b = b.on_target[k];
    if (at_a >= 0) out.push_back(a);
    if ((at_a >= 0) == (at_b >= 0)) continue;
    out.push_back(between(a, b, at_a / (at_a - at_b)));
    out.back().on_target[k] = 0; // on the edge, not merely close to it
  }
  return out;
}

double doubled_area(const OverlayCorner& a, const OverlayCorner& b, const OverlayCorner& c) {
  return (b.on_target[0] - a.on_target[0]) * (c.on_target[1] - a.on_target[1]) -
         (c.on_target[0] - a.on_target[0]) * (b.on_target[1] - a.on_target[1]);
}

// The parts of one block of target triangles.
struct Block {
  std::vector<texture::CutVertex> vertices;
  std::vector<mesh::Triangle> triangles;
  std::vector<std::uint32_t> parent, chart;
};

class Overlay {
public:
  Overlay(const texture::CutMesh& target, std::span<const Vec3d> directions)
      : target_(target), directions_(directions) {
    out_.charts = target.charts;
    out_.pages = target.pages;
    out_.gutter = target.gutter;
  }

  void add(const OverlayPair& pair, mesh::ThreadPool& pool) {
    const SphereTree tree(pair.source_points, pair.source_triangles);
    const std::size_t count = pair.end_piece - pair.first_piece;
    std::vector<Block> blocks((count + grain - 1) / grain);
    pool.for_blocks(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        cut(pair, tree, pair.first_piece + static_cast<std::uint32_t>(i), blocks[begin / grain]);
    });
    for (const Block& block : blocks) append(block);
  }

  texture::CutMesh take() {
    out_.points = out_.vertices.size();
    return std::move(out_);
  }

private:
  void cut(const OverlayPair& pair, const SphereTree& tree, std::uint32_t piece, Block& block) const {
    const mesh::Triangle& t = target_.triangles[piece];
    const std::array<Vec3d, 3> corners{directions_[t[0]], directions_[t[1]], directions_[t[2]]};
    std::vector<std::uint32_t> close;
    tree.near(corners, [&](std::uint32_t s) { close.push_back(s); });
    std::sort(close.begin(), close.end());
    for (const std::uint32_t s : close) {
      const auto& [a, b, c] = pair.source_triangles[s];
      const std::vector<OverlayCorner> part =
          common_part({pair.source_points[a], pair.source_points[b], pair.source_points[c]}, corners);
      add_part(part, pair.first_source_triangle + s, piece, block);
    }
  }

  void add_part(const std::vector<OverlayCorner>& part, std::uint32_t source, std::uint32_t piece, Block& block) const {
    double area = 0;
    for (std::size_t i = 2; i < part.size(); ++i) area += doubled_area(part[0], part[i - 1], part[i]);
    if (!(area > smallest_area)) return;
    const auto first = static_cast<mesh::Index>(block.vertices.size());
    for (const OverlayCorner& corner : part) block.vertices.push_back(vertex_at(corner, source, piece));
    for (std::size_t i = 2; i < part.size(); ++i) {
      block.triangles.push_back({first, first + static_cast<mesh::Index>(i) - 1, first + static_cast<mesh::Index>(i)});
      block.parent.push_back(source);
      block.chart.push_back(target_.chart[piece]);
    }
  }

  [[nodiscard]] texture::CutVertex vertex_at(const OverlayCorner& corner, std::uint32_t source,
                                             std::uint32_t piece) const {
    double u = 0, v = 0;
    Vec3d on_sphere;
    for (std::size_t k = 0; k < 3; ++k) {
      const texture::CutVertex& at = target_.vertices[target_.triangles[piece][k]];
      u += corner.on_target[k] * at.uv.x;
      v += corner.on_target[k] * at.uv.y;
      on_sphere += Vec3d(sphere::from_grid(at.sphere)) * corner.on_target[k];
    }
    return {source, corner.on_source, sphere::to_grid(normalized(on_sphere)),
            Vec2f{static_cast<float>(u), static_cast<float>(v)}, 0};
  }

  void append(const Block& block) {
    const auto first = static_cast<mesh::Index>(out_.vertices.size());
    for (texture::CutVertex v : block.vertices) {
      v.point = static_cast<std::uint32_t>(out_.vertices.size());
      out_.vertices.push_back(v);
    }
    for (const auto& [a, b, c] : block.triangles) out_.triangles.push_back({first + a, first + b, first + c});
    out_.parent.insert(out_.parent.end(), block.parent.begin(), block.parent.end());
    out_.chart.insert(out_.chart.end(), block.chart.begin(), block.chart.end());
  }

  const texture::CutMesh& target_;
  std::span<const Vec3d> directions_;
  texture::CutMesh out_;
};

} // namespace

std::vector<OverlayCorner> common_part(const std::array<Vec3d, 3>& source, const std::array<Vec3d, 3>& target) {
  const double whole = dot(target[0], cross(target[1] - target[0], target[2] - target[0]));
  if (!(whole > 0)) return {};
  std::array<Vec3d, 3> normal; // of the plane through the centre and the edge across from each corner
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = target[(k + 1) % 3], &b = target[(k + 2) % 3];
    normal[k] = cross(a, b - a) * (1 / whole);
  }
  std::vector<OverlayCorner> polygon(3);
  for (std::size_t i = 0; i < 3; ++i) {
    polygon[i].on_source[i] = 1;
    // det(p, a, b) = (p - a) . (a x (b - a)): from differences, which lose fewer digits.
    for (std::size_t k = 0; k < 3; ++k) polygon[i].on_target[k] = dot(source[i] - target[(k + 1) % 3], normal[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::all_of(polygon.begin(), polygon.end(), [k](const OverlayCorner& c) { return c.on_target[k] < 0; }))
      return {};
  }
  for (std::size_t k = 0; k < 3; ++k) polygon = clipped(polygon, k);
  if (polygon.size() < 3) return {};
  for (OverlayCorner& corner : polygon) {
    const double sum = corner.on_target[0] + corner.on_target[1] + corner.on_target[2];
    if (!(sum > 0)) return {};
    for (double& weight : corner.on_target) weight /= sum;
  }
  return polygon;
}

texture::CutMesh overlay(const texture::CutMesh& target, std::span<const Vec3d> directions,
                         std::span<const OverlayPair> pairs, mesh::ThreadPool& pool) {
  Overlay out(target, directions);
  for (const OverlayPair& pair : pairs) out.add(pair, pool);
  return out.take();
}

} // namespace orbis::remesh
