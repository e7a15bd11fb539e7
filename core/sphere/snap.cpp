#include "core/sphere/snap.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sphere/star_table.h"

namespace orbis::sphere {
namespace {

constexpr int reach = 3;  // grid units that a vertex may move along each axis
constexpr int rounds = 8; // over the folded triangles

// The offsets of a cube of grid points, nearest first, without the centre.
std::vector<GridPoint> offsets_by_distance() {
  std::vector<GridPoint> out;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        if (x != 0 || y != 0 || z != 0) out.push_back({x, y, z});
      }
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const GridPoint& a, const GridPoint& b) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2] < b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
  });
  return out;
}

class Unfolder {
public:
  Unfolder(std::span<const mesh::Triangle> triangles, std::vector<GridPoint>& points)
      : triangles_(triangles), points_(points), offsets_(offsets_by_distance()) {
    mesh::ThreadPool alone(1);
    stars_.build(triangles, points.size(), alone);
  }

  // Moves one vertex of the triangle so that fewer triangles of its star are folded. Returns whether it could.
  bool mend(std::uint32_t t) {
    return std::ranges::any_of(triangles_[t], [&](mesh::Index v) { return move(v); });
  }

private:
  [[nodiscard]] std::size_t folds(mesh::Index v, const GridPoint& at) const {
    const std::span<const StarCorner> star = stars_[v];
    std::size_t count = 0;
    for (std::size_t k = 0; k < star.size(); ++k) {
      if (orientation(at, points_[star[k].next], points_[previous_in(star, k)]) != 1) ++count;
    }
    return count;
  }

  bool move(mesh::Index v) {
    const GridPoint old = points_[v];
    std::size_t fewest = folds(v, old);
    const std::size_t before = fewest;
    for (const GridPoint& d : offsets_) {
      const GridPoint p{old[0] + d[0], old[1] + d[1], old[2] + d[2]};
      if (std::ranges::any_of(p, [](std::int32_t c) { return std::abs(c) > 1 << grid_bits; })) continue;
      const std::size_t here = folds(v, p);
      if (here >= fewest) continue;
      fewest = here;
      points_[v] = p;
      if (here == 0) break;
    }
    return fewest < before;
  }

  std::span<const mesh::Triangle> triangles_;
  std::vector<GridPoint>& points_;
  std::vector<GridPoint> offsets_;
  StarTable stars_;
};

std::vector<std::uint32_t> folded_triangles(std::span<const mesh::Triangle> triangles,
                                            std::span<const GridPoint> points) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const mesh::Triangle& v = triangles[t];
    if (orientation(points[v[0]], points[v[1]], points[v[2]]) != 1) out.push_back(t);
  }
  return out;
}

} // namespace

Snapped snap(std::span<const Vec3d> points, std::span<const mesh::Triangle> triangles) {
  Snapped out;
  out.points.reserve(points.size());
  for (const Vec3d& p : points) out.points.push_back(to_grid(p));
  std::vector<std::uint32_t> folded = folded_triangles(triangles, out.points);
  if (folded.empty()) return out;
  Unfolder unfolder(triangles, out.points);
  for (int round = 0; round < rounds && !folded.empty(); ++round) {
    std::uint64_t moved = 0;
    for (const std::uint32_t t : folded) moved += unfolder.mend(t) ? 1 : 0;
    out.moved += moved;
    if (moved == 0) break;
    folded = folded_triangles(triangles, out.points);
  }
  out.folded = folded.size();
  return out;
}

} // namespace orbis::sphere
