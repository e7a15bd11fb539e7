#include <algorithm>
#include <unordered_set>

#include "core/lod/refine.h"

namespace orbis::lod {
namespace {

constexpr int sweeps = 2;
constexpr double least_gain = 1e-3;
constexpr double least_cosine = 0.2; // between a new triangle and the two old ones

// Two numbers in one, the smaller first.
std::uint64_t pair_of(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

// The edge from corner k to k + 1 of a triangle, by its ends.
struct Side {
  std::uint64_t ends = 0;
  std::uint32_t triangle = 0, corner = 0;

  friend bool operator<(const Side& x, const Side& y) {
    return x.ends != y.ends ? x.ends < y.ends : x.triangle < y.triangle;
  }
};

class Flips {
public:
  explicit Flips(Draft& draft) : draft_(draft), mesh_(draft.level().mesh) {
    joined_.reserve(2 * mesh_.triangles.size());
    for (const mesh::Triangle& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) joined_.insert(points_of(t[k], t[(k + 1) % 3]));
  }

  // How many edges were flipped; no triangle takes part in two of them.
  std::size_t sweep() {
    std::vector<Side> sides;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k)
        sides.push_back({pair_of(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]), t, k});
    std::sort(sides.begin(), sides.end());
    std::vector<bool> is_new(mesh_.triangles.size());
    std::size_t flips = 0;
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const Side &s = sides[i], &t = sides[i + 1];
      if (s.ends != t.ends || is_new[s.triangle] || is_new[t.triangle] || !flip(s, t)) continue;
      is_new[s.triangle] = is_new[t.triangle] = true;
      ++flips;
    }
    return flips;
  }

private:
  [[nodiscard]] std::uint64_t points_of(mesh::Index v, mesh::Index w) const {
    return pair_of(mesh_.vertices[v].point, mesh_.vertices[w].point);
  }

  // (a, b, c) and (b, a, d) become (c, a, d) and (d, b, c).
  bool flip(const Side& s, const Side& t) {
    const Level& level = draft_.level();
    if (level.regions[s.triangle] != level.regions[t.triangle]) return false;
    const mesh::Triangle one = mesh_.triangles[s.triangle], two = mesh_.triangles[t.triangle];
    const mesh::Index a = one[s.corner], b = one[(s.corner + 1) % 3], c = one[(s.corner + 2) % 3];
    const mesh::Index d = two[(t.corner + 2) % 3];
    const std::uint64_t diagonal = points_of(c, d);
    if (mesh_.vertices[c].point == mesh_.vertices[d].point || joined_.contains(diagonal)) return false;
    const std::array<mesh::Triangle, 2> before{one, two}, after{mesh::Triangle{c, a, d}, mesh::Triangle{d, b, c}};
    const int sign = draft_.atlas_orientation(one);
    const Vec3d normal = draft_.area_normal(one) + draft_.area_normal(two);
    for (const mesh::Triangle& triangle : after) {
      const Vec3d n = draft_.area_normal(triangle);
      if (!draft_.is_sound(triangle, sign) || !(dot(n, normal) > least_cosine * norm(n) * norm(normal))) return false;
    }
    const std::array numbers{s.triangle, t.triangle};
    draft_.collect(numbers, held_);
    const double energy = draft_.energy(held_, before);
    if (!(draft_.energy(held_, after) < (1 - least_gain) * energy)) return false;
    mesh_.triangles[s.triangle] = after[0];
    mesh_.triangles[t.triangle] = after[1];
    joined_.erase(points_of(a, b));
    joined_.insert(diagonal);
    draft_.hand_over(held_, numbers);
    return true;
  }

  Draft& draft_;
  texture::CutMesh& mesh_;
  std::unordered_set<std::uint64_t> joined_; // pairs of points
  std::vector<Held> held_;
};

} // namespace

void flip_edges(Draft& draft) {
  Flips flips(draft);
  for (int i = 0; i < sweeps && flips.sweep() > 0; ++i) {
  }
}

} // namespace orbis::lod
