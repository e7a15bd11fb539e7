#include "core/mesh/t_junctions.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace orbis::mesh {
namespace {

constexpr double rounding = 1e-6; // of the longer edge

class Zipper {
public:
  Zipper(std::span<const Vec3f> positions, double tolerance, Gluing& gluing)
      : positions_(positions), tolerance_(tolerance), gluing_(gluing) {
    for (std::uint32_t h = 0; h < gluing.twin.size(); ++h) {
      if (gluing.is_open(h)) add(h);
    }
  }

  std::uint64_t run() {
    // In the order of the points, whatever the order of the table.
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      while (const auto crack = crack_at(points_[i])) close(crack->first, crack->second);
    }
    return added_;
  }

private:
  struct Ends {
    std::vector<std::uint32_t> out, in; // open half-edges
  };

  void add(std::uint32_t h) {
    open_[gluing_.from(h)].out.push_back(h);
    open_[gluing_.to(h)].in.push_back(h);
    points_.push_back(gluing_.from(h));
    points_.push_back(gluing_.to(h));
  }

  void remove(std::uint32_t h) {
    std::erase(open_[gluing_.from(h)].out, h);
    std::erase(open_[gluing_.to(h)].in, h);
  }

  // An open edge that leaves the point and one that comes in along it. The pair that is closest in length first: with
  // several cracks at a point the neighbours belong together.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> crack_at(Index point) {
    const Ends& ends = open_[point];
    for (const std::uint32_t out : ends.out) {
      for (const std::uint32_t in : ends.in) {
        if (out / 3 != in / 3 && lie_together(point, gluing_.to(out), gluing_.from(in))) return std::pair{out, in};
      }
    }
    return std::nullopt;
  }

  // Does one of b and m lie on the segment from a to the other?
  [[nodiscard]] bool lie_together(Index a, Index b, Index m) const {
    if (b == m) return false;
    Vec3d longer = Vec3d(positions_[b]) - Vec3d(positions_[a]), shorter = Vec3d(positions_[m]) - Vec3d(positions_[a]);
    if (squared_norm(longer) < squared_norm(shorter)) std::swap(longer, shorter);
    const double length = norm(longer), along = dot(longer, shorter) / length;
    const double allowed = std::max(tolerance_, rounding * length);
    // Within the tolerance of an end the vertices would have been welded, or the crack is only as long as it is wide.
    if (!(along > allowed && along < length)) return false;
    return norm(cross(longer, shorter)) / length <= allowed;
  }

  void close(std::uint32_t out, std::uint32_t in) {
    const Index a = gluing_.from(out), b = gluing_.to(out), m = gluing_.from(in);
    const auto h = static_cast<std::uint32_t>(gluing_.twin.size());
    gluing_.triangles.push_back({b, a, m});
    gluing_.twin.insert(gluing_.twin.end(), 3, open_edge);
    ++added_;
    remove(out);
    remove(in);
    gluing_.glue(h, out);
    gluing_.glue(h + 1, in);
    // What is left of the crack runs from m to b: it may meet its other side now.
    const std::vector<std::uint32_t>& back = open_[b].out;
    const auto other = std::ranges::find_if(back, [&](std::uint32_t g) { return gluing_.to(g) == m; });
    if (other == back.end()) {
      add(h + 2);
    } else {
      const std::uint32_t g = *other;
      remove(g);
      gluing_.glue(h + 2, g);
    }
  }

  std::span<const Vec3f> positions_;
  double tolerance_;
  Gluing& gluing_;
  std::unordered_map<Index, Ends> open_;
  std::vector<Index> points_;
  std::uint64_t added_ = 0;
};

} // namespace

std::uint64_t close_t_junctions(std::span<const Vec3f> positions, double tolerance, Gluing& gluing) {
  return Zipper(positions, tolerance, gluing).run();
}

} // namespace orbis::mesh
