#include "core/lod/full_surface.h"

#include <algorithm>
#include <cmath>

#include "core/lod/deviation_quadric.h"
#include "core/mesh/edges.h"
#include "core/texture/canvas.h"

namespace orbis::lod {
namespace {

// Where normals turn by a radian within this length (a fraction of the diagonal: two pixels of a picture of 512), half
// of the weight is reached that a crease has. docs/lods.md says what it is worth.
constexpr double crease_length = 0.004;
constexpr double crease_weight = 10; // more than that of a flat part

double area_of(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  return 0.5 * ((double{b.x} - a.x) * (double{c.y} - a.y) - (double{c.x} - a.x) * (double{b.y} - a.y));
}

} // namespace

FullSurface::FullSurface(const mesh::TriangleMesh& surface, std::span<const std::uint32_t> primitive_of,
                         const texture::CutMesh& cut)
    : surface_(surface), cut_(cut) {
  scale_positions();
  weigh();
  number_regions(primitive_of);
  chart_map_.emplace(cut_, regions_);
  find_joints();
}

void FullSurface::scale_positions() {
  positions_.reserve(cut_.vertices.size());
  for (const texture::CutVertex& v : cut_.vertices)
    positions_.push_back(texture::interpolated(surface_.positions, surface_.triangles, v));
  if (positions_.empty()) return;
  Vec3d low = positions_[0], high = positions_[0];
  for (const Vec3d& p : positions_) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  centre_ = low * 0.5 + high * 0.5;
  diagonal_ = norm(high - low);
  for (Vec3d& p : positions_) p = (p - centre_) * (1 / diagonal_);

  double in_space = 0, in_atlas = 0;
  for (const auto& [a, b, c] : cut_.triangles) {
    in_space += 0.5 * norm(cross(positions_[b] - positions_[a], positions_[c] - positions_[a]));
    in_atlas += std::abs(area_of(cut_.vertices[a].uv, cut_.vertices[b].uv, cut_.vertices[c].uv));
  }
  uv_scale_ = in_atlas > 0 ? std::sqrt(in_space / in_atlas) : 1;
}

// Not by the product of both: that many there may be only of a few.
void FullSurface::number_regions(std::span<const std::uint32_t> primitive_of) {
  const auto meaning = [&](std::size_t t) { return std::pair(cut_.chart[t], primitive_of[cut_.parent[t]]); };
  const std::size_t triangles = cut_.triangles.size();
  meaning_.reserve(triangles);
  for (std::size_t t = 0; t < triangles; ++t) meaning_.push_back(meaning(t));
  std::sort(meaning_.begin(), meaning_.end());
  meaning_.erase(std::unique(meaning_.begin(), meaning_.end()), meaning_.end());
  regions_.reserve(triangles);
  for (std::size_t t = 0; t < triangles; ++t)
    regions_.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(meaning_, meaning(t)) - meaning_.begin()));
}

void FullSurface::weigh() {
  const std::vector<Vec3d> smooth = texture::smooth_normals(cut_, positions_);
  normals_.reserve(cut_.triangles.size());
  weighings_.reserve(cut_.triangles.size());
  for (const auto& [a, b, c] : cut_.triangles) {
    const Vec3d e1 = positions_[b] - positions_[a], e2 = positions_[c] - positions_[a], area = cross(e1, e2);
    const double length = norm(area);
    normals_.push_back(length > 0 ? area * (1 / length) : Vec3d{});
    if (!(length > 0)) {
      weighings_.emplace_back();
      continue;
    }
    // |grad n|^2 of the normals' linear interpolation over the triangle.
    const Vec3d d1 = smooth[b] - smooth[a], d2 = smooth[c] - smooth[a];
    const double turning =
        (squared_norm(e2) * squared_norm(d1) - 2 * dot(e1, e2) * dot(d1, d2) + squared_norm(e1) * squared_norm(d2)) /
        (length * length);
    const double bend = crease_length * crease_length * turning, more = crease_weight * bend / (1 + bend);
    weighings_.push_back({0.5 * length * (1 + more), (slip + more) / (1 + more)});
  }
}

// Vertices of the welded surface on edges with one triangle, at whose place there is another such vertex.
void FullSurface::find_joints() {
  joint_.assign(surface_.positions.size(), none);
  std::vector<mesh::Triangle> points;
  points.reserve(cut_.triangles.size());
  for (const auto& [a, b, c] : cut_.triangles)
    points.push_back({cut_.vertices[a].point, cut_.vertices[b].point, cut_.vertices[c].point});
  std::vector<mesh::Index> rim;
  const mesh::EdgeTable edges(points, cut_.points);
  edges.for_each([&](mesh::Index low, mesh::Index high, std::span<const mesh::EdgeSide> sides) {
    if (sides.size() != 1) return;
    for (const mesh::Index v : {low, high})
      if (v < joint_.size()) rim.push_back(v);
  });
  const auto key = [&](mesh::Index v) {
    const Vec3f& p = surface_.positions[v];
    return std::array{p.x, p.y, p.z};
  };
  std::sort(rim.begin(), rim.end(),
            [&](mesh::Index a, mesh::Index b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::uint32_t joints = 0;
  for (std::size_t i = 1; i < rim.size(); ++i) {
    if (rim[i] == rim[i - 1] || key(rim[i]) != key(rim[i - 1])) continue;
    if (joint_[rim[i - 1]] == none) joint_[rim[i - 1]] = joints++;
    joint_[rim[i]] = joint_[rim[i - 1]];
  }
}

bool FullSurface::is_joint(const texture::CutVertex& vertex) const {
  const mesh::Triangle& corners = surface_.triangles[vertex.triangle];
  bool is_joint = true;
  for (std::size_t k = 0; k < 3; ++k) is_joint = is_joint && (vertex.barycentric[k] == 0 || joint_[corners[k]] != none);
  return is_joint;
}

std::uint32_t FullSurface::joint_of(const texture::CutVertex& vertex) const {
  const mesh::Triangle& corners = surface_.triangles[vertex.triangle];
  for (std::size_t k = 0; k < 3; ++k)
    if (vertex.barycentric[k] == 1) return joint_[corners[k]];
  return none;
}

Vec3d FullSurface::position(const Place& place) const {
  Vec3d p;
  for (std::size_t k = 0; k < 3; ++k) p += positions_[cut_.triangles[place.triangle][k]] * place.weights[k];
  return p;
}

std::array<double, 3> FullSurface::weights_on_parent(const Place& place) const {
  std::array<double, 3> weights{};
  const mesh::Triangle& parent = surface_.triangles[cut_.parent[place.triangle]];
  for (std::size_t k = 0; k < 3; ++k) {
    const texture::CutVertex& v = cut_.vertices[cut_.triangles[place.triangle][k]];
    for (std::size_t i = 0; i < 3; ++i) {
      // A vertex on an edge or at a corner may name the triangle on its other side: they share the vertices that count.
      const mesh::Index id = surface_.triangles[v.triangle][i];
      for (std::size_t j = 0; j < 3; ++j)
        if (parent[j] == id) weights[j] += place.weights[k] * v.barycentric[i];
    }
  }
  return weights;
}

sphere::GridPoint FullSurface::sphere_point(const Place& place) const {
  Vec3d s;
  for (std::size_t k = 0; k < 3; ++k)
    s += Vec3d(sphere::from_grid(cut_.vertices[cut_.triangles[place.triangle][k]].sphere)) * place.weights[k];
  return sphere::to_grid(normalized(s));
}

} // namespace orbis::lod
