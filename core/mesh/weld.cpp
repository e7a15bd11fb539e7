#include "core/mesh/weld.h"

#include <bit>
#include <cmath>
#include <unordered_map>

namespace orbis::mesh {
namespace {

// The bits of a coordinate, with -0 as +0, so that equal numbers have equal bits (NaN does not come here).
std::uint32_t bits_of(float v) { return std::bit_cast<std::uint32_t>(v + 0.0F); }

std::uint64_t hash(const Vec3f& p) {
  // One multiply-rotate round a coordinate: cheap, and good enough for open addressing at half load.
  std::uint64_t h = 0x9E3779B97F4A7C15ULL;
  for (const float c : {p.x, p.y, p.z}) h = std::rotl((h ^ bits_of(c)) * 0xD6E8FEB86659FD93ULL, 29);
  return h ^ (h >> 32);
}

// Numbers the used vertices' distinct positions in the order of the vertices: open addressing at no more than half
// load.
std::vector<Index> number_positions(std::span<const Vec3f> positions, const std::vector<bool>& used,
                                    std::vector<Vec3f>& distinct) {
  std::vector<Index> table(std::bit_ceil(positions.size() * 2 + 1), unreferenced);
  const std::size_t mask = table.size() - 1;
  std::vector<Index> number(positions.size(), unreferenced);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    std::size_t slot = hash(positions[v]) & mask;
    while (table[slot] != unreferenced && !(distinct[table[slot]] == positions[v])) slot = (slot + 1) & mask;
    if (table[slot] == unreferenced) {
      table[slot] = static_cast<Index>(distinct.size());
      distinct.push_back(positions[v]);
    }
    number[v] = table[slot];
  }
  return number;
}

std::vector<bool> used_vertices(std::size_t count, std::span<const Triangle> triangles) {
  std::vector<bool> used(count, false);
  for (const Triangle& t : triangles) {
    for (const Index v : t) used[v] = true;
  }
  return used;
}

Welded collect(std::span<const Triangle> triangles, std::vector<Index> vertex_of, std::vector<Vec3f> positions) {
  Welded out;
  out.mesh.positions = std::move(positions);
  out.mesh.triangles.reserve(triangles.size());
  out.triangle_of.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle w{vertex_of[triangles[t][0]], vertex_of[triangles[t][1]], vertex_of[triangles[t][2]]};
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) {
      out.degenerate.push_back(t);
    } else {
      out.mesh.triangles.push_back(w);
      out.triangle_of.push_back(t);
    }
  }
  out.vertex_of = std::move(vertex_of);
  return out;
}

// Cells of a grid as wide as the tolerance, so that a neighbour is at most one cell away in each direction.
class Neighbours {
public:
  explicit Neighbours(double tolerance) : tolerance_(tolerance) {}

  // The nearest of the points that were added, if one is within the tolerance.
  [[nodiscard]] Index nearest(const Vec3f& p, std::span<const Vec3f> points) const {
    Index best = unreferenced;
    double least = tolerance_ * tolerance_;
    for (int i = 0; i < 27; ++i) {
      const auto cell = cells_.find(key(p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      if (cell == cells_.end()) continue;
      for (const Index v : cell->second) {
        const double distance = squared_norm(Vec3d(points[v]) - Vec3d(p));
        if (distance > least || (distance == least && v > best)) continue;
        least = distance;
        best = v;
      }
    }
    return best;
  }
  void add(const Vec3f& p, Index v) { cells_[key(p, 0, 0, 0)].push_back(v); }

private:
  // Different cells with one key only cost time.
  [[nodiscard]] std::uint64_t key(const Vec3f& p, int dx, int dy, int dz) const {
    const auto along = [&](float c, int d) {
      return std::bit_cast<std::uint64_t>(std::floor(c / tolerance_) + d + 0.0);
    };
    std::uint64_t h = 0x9E3779B97F4A7C15ULL;
    for (const std::uint64_t c : {along(p.x, dx), along(p.y, dy), along(p.z, dz)}) {
      h = std::rotl((h ^ c) * 0xD6E8FEB86659FD93ULL, 29);
    }
    return h;
  }

  double tolerance_;
  std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

} // namespace

Welded weld_within(std::span<const Vec3f> positions, std::span<const Triangle> triangles, double tolerance) {
  const std::vector<bool> used = used_vertices(positions.size(), triangles);
  std::vector<Index> vertex_of(positions.size(), unreferenced);
  std::vector<Vec3f> kept;
  Neighbours neighbours(tolerance);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    vertex_of[v] = neighbours.nearest(positions[v], kept);
    if (vertex_of[v] != unreferenced) continue;
    vertex_of[v] = static_cast<Index>(kept.size());
    neighbours.add(positions[v], vertex_of[v]);
    kept.push_back(positions[v]);
  }
  return collect(triangles, std::move(vertex_of), std::move(kept));
}

Welded weld(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  std::vector<Vec3f> distinct;
  std::vector<Index> vertex_of = number_positions(positions, used_vertices(positions.size(), triangles), distinct);
  return collect(triangles, std::move(vertex_of), std::move(distinct));
}

Welded keep_indices(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  const std::vector<bool> used = used_vertices(positions.size(), triangles);
  std::vector<Index> vertex_of(positions.size(), unreferenced);
  std::vector<Vec3f> kept;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    vertex_of[v] = static_cast<Index>(kept.size());
    kept.push_back(positions[v]);
  }
  return collect(triangles, std::move(vertex_of), std::move(kept));
}

} // namespace orbis::mesh
