#include "core/texture/tangents.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/mesh/edges.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// Position, normal and uv as bits, -0 as 0.
using VertexKey = std::array<std::uint32_t, 8>;

struct KeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t h = 0x9E3779B97F4A7C15U;
    for (const std::uint32_t word : key) h = (h ^ word) * 0xD6E8FEB86659FD93U ^ (h >> 29U);
    return static_cast<std::size_t>(h ^ (h >> 32U));
  }
};

VertexKey key_of(const Vec3f& p, const Vec3f& n, const Vec2f& uv) {
  VertexKey key{};
  const std::array<float, 8> values{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = std::bit_cast<std::uint32_t>(values[i] + 0.0F);
  return key;
}

Vec3d in_plane_of(const Vec3d& normal, const Vec3d& v) {
  const Vec3d projected = v - normal * dot(normal, v);
  const double length = norm(projected);
  return length > std::numeric_limits<float>::min() ? projected * (1 / length) : Vec3d{};
}

Vec3d any_perpendicular(const Vec3d& normal) {
  const Vec3d axis = std::abs(normal.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d v = in_plane_of(normal, axis);
  return v == Vec3d{} ? Vec3d{1, 0, 0} : v; // a normal that is none
}

// How the texture lies on a triangle.
struct Mapping {
  Vec3d u;              // unit, along growing u
  bool upright = true;  // not mirrored: w = +1
  bool adapts = true;   // no area in the texture, or no direction: takes the side of the neighbours
  bool a_point = false; // no area in space, by coinciding corners: says nothing about its neighbours
};

class Builder {
public:
  Builder(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const Vec2f> uv,
          std::span<const mesh::Triangle> triangles)
      : positions_(positions), normals_(normals), uv_(uv), input_(triangles) {
    join();
    for (std::size_t t = 0; t < input_.size(); ++t) mappings_.push_back(mapping_of(t));
    pair_edges();
  }

  std::vector<std::array<Tangent, 3>> run() {
    out_.resize(input_.size());
    assigned_.assign(3 * input_.size(), false);
    first_of_vertex_.assign(vertex_count_, none);
    for (std::uint32_t corner = 0; corner < assigned_.size(); ++corner) {
      const Mapping& m = mappings_[corner / 3];
      if (!m.adapts && !m.a_point && !assigned_[corner]) finish_group(corner);
    }
    for (std::uint32_t corner = 0; corner < assigned_.size(); ++corner) {
      if (!assigned_[corner]) take_from_vertex(corner);
    }
    return std::move(out_);
  }

private:
  void join() {
    std::unordered_map<VertexKey, std::uint32_t, KeyHash> known;
    known.reserve(positions_.size());
    std::vector<std::uint32_t> vertex(positions_.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      const auto next = static_cast<std::uint32_t>(known.size());
      vertex[v] = known.try_emplace(key_of(positions_[v], normals_[v], uv_[v]), next).first->second;
    }
    vertex_count_ = known.size();
    for (const auto& [a, b, c] : input_) triangles_.push_back({vertex[a], vertex[b], vertex[c]});
  }

  [[nodiscard]] Vec3d position(std::size_t t, std::size_t k) const { return Vec3d(positions_[input_[t][k]]); }

  // With d1, d2 the sides in space and (u1, v1), (u2, v2) those in the texture, the direction of growing u is
  // (v2 d1 - v1 d2) / (u1 v2 - u2 v1).
  [[nodiscard]] Mapping mapping_of(std::size_t t) const {
    const auto& [a, b, c] = input_[t];
    const Vec3d d1 = position(t, 1) - position(t, 0), d2 = position(t, 2) - position(t, 0);
    const double u1 = double{uv_[b].x} - uv_[a].x, v1 = double{uv_[b].y} - uv_[a].y;
    const double u2 = double{uv_[c].x} - uv_[a].x, v2 = double{uv_[c].y} - uv_[a].y;
    const double area = u1 * v2 - u2 * v1;
    const Vec3d u = d1 * v2 - d2 * v1;
    const double length = norm(u);
    Mapping m;
    m.a_point = d1 == Vec3d{} || d2 == Vec3d{} || d1 == d2;
    m.upright = area < 0; // v runs down
    m.adapts = !(std::abs(area) > std::numeric_limits<float>::min()) || !(length > 0) || !std::isfinite(length);
    if (!m.adapts) m.u = u * ((area < 0 ? -1 : 1) / length);
    return m;
  }

  // neighbour_[h]: the half-edge on the other side of h. Where more than two triangles meet, pairs in their order.
  void pair_edges() {
    neighbour_.assign(3 * triangles_.size(), none);
    std::vector<mesh::Triangle> solid;
    std::vector<std::uint32_t> number;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (mappings_[t].a_point || a == b || b == c || c == a) continue;
      solid.push_back(triangles_[t]);
      number.push_back(t);
    }
    const auto half_edge = [&](const mesh::EdgeSide& side) {
      return 3 * number[side.half_edge / 3] + side.half_edge % 3;
    };
    mesh::EdgeTable(solid, vertex_count_)
        .for_each([&](mesh::Index, mesh::Index, std::span<const mesh::EdgeSide> sides) {
          for (std::size_t i = 0; i < sides.size(); ++i) {
            const std::uint32_t h = half_edge(sides[i]);
            for (std::size_t j = i + 1; j < sides.size() && neighbour_[h] == none; ++j) {
              const std::uint32_t g = half_edge(sides[j]);
              if (neighbour_[g] != none || start(g) == start(h)) continue;
              neighbour_[h] = g;
              neighbour_[g] = h;
            }
          }
        });
  }

  [[nodiscard]] mesh::Index start(std::uint32_t half_edge) const { return triangles_[half_edge / 3][half_edge % 3]; }
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

  // The corners around one vertex that are reached across edges and have the handedness of the first. A triangle that
  // adapts takes the handedness of the group that reaches it first.
  std::vector<std::uint32_t> group_of(std::uint32_t first) {
    std::vector<std::uint32_t> group, waiting{first};
    const bool upright = mappings_[first / 3].upright;
    while (!waiting.empty()) {
      const std::uint32_t corner = waiting.back();
      waiting.pop_back();
      if (assigned_[corner]) continue;
      Mapping& m = mappings_[corner / 3];
      if (m.adapts && !assigned_[corner] && !assigned_[next(corner)] && !assigned_[previous(corner)])
        m.upright = upright;
      if (m.upright != upright) continue;
      assigned_[corner] = true;
      group.push_back(corner);
      // Half-edge `corner` starts at the vertex, the one before it ends there.
      if (const std::uint32_t h = neighbour_[corner]; h != none) waiting.push_back(next(h));
      if (const std::uint32_t h = neighbour_[previous(corner)]; h != none) waiting.push_back(h);
    }
    return group;
  }

  void finish_group(std::uint32_t first) {
    const std::vector<std::uint32_t> group = group_of(first);
    const Vec3d normal(normals_[input_[first / 3][first % 3]]);
    Vec3d sum;
    for (const std::uint32_t corner : group) {
      const std::size_t t = corner / 3, k = corner % 3;
      if (mappings_[t].adapts) continue;
      const Vec3d here = position(t, k);
      const Vec3d a = in_plane_of(normal, position(t, (k + 1) % 3) - here);
      const Vec3d b = in_plane_of(normal, position(t, (k + 2) % 3) - here);
      sum += in_plane_of(normal, mappings_[t].u) * std::acos(std::clamp(dot(a, b), -1.0, 1.0));
    }
    const double length = norm(sum);
    const Vec3d direction = length > 0 ? sum * (1 / length) : any_perpendicular(normal);
    for (const std::uint32_t corner : group) set(corner, direction, mappings_[first / 3].upright);
    std::uint32_t& known = first_of_vertex_[start(first)];
    if (known == none) known = first;
  }

  // Corners that no group reached: as another triangle at the same vertex.
  void take_from_vertex(std::uint32_t corner) {
    const std::uint32_t known = first_of_vertex_[start(corner)];
    if (known != none) {
      out_[corner / 3][corner % 3] = out_[known / 3][known % 3];
    } else {
      set(corner, any_perpendicular(Vec3d(normals_[input_[corner / 3][corner % 3]])), true);
    }
  }

  void set(std::uint32_t corner, const Vec3d& direction, bool upright) {
    out_[corner / 3][corner % 3] = {static_cast<float>(direction.x), static_cast<float>(direction.y),
                                    static_cast<float>(direction.z), upright ? 1.0F : -1.0F};
  }

  std::span<const Vec3f> positions_, normals_;
  std::span<const Vec2f> uv_;
  std::span<const mesh::Triangle> input_;
  std::vector<mesh::Triangle> triangles_; // with equal vertices joined
  std::size_t vertex_count_ = 0;
  std::vector<Mapping> mappings_;              // by triangle
  std::vector<std::uint32_t> neighbour_;       // by half-edge
  std::vector<bool> assigned_;                 // by corner
  std::vector<std::uint32_t> first_of_vertex_; // joined vertex -> a corner of its first group
  std::vector<std::array<Tangent, 3>> out_;
};

} // namespace

std::vector<std::array<Tangent, 3>> corner_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                                                    std::span<const Vec2f> uv,
                                                    std::span<const mesh::Triangle> triangles) {
  return Builder(positions, normals, uv, triangles).run();
}

} // namespace orbis::texture
