#include "core/sphere/floater_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace orbis::sphere {
namespace {

// How far from degenerate a star is kept: edges relative to its longest, angles relative to the mean of its angles.
constexpr double degeneracy = 1e-6;

// The star in the plane: neighbour k lies at polar coordinates (radius[k], direction[k]) about the centre.
// direction has one entry more than radius: direction[d] = 2 pi.
struct FlatStar {
  std::vector<double> radius, direction;
};

std::vector<double> edge_lengths(const Vec3d& centre, std::span<const Vec3d> ring) {
  std::vector<double> length(ring.size());
  std::transform(ring.begin(), ring.end(), length.begin(), [&](const Vec3d& q) { return norm(q - centre); });
  const double longest = *std::max_element(length.begin(), length.end());
  for (double& l : length) l = longest == 0 ? 1 : std::max(l / longest, degeneracy);
  return length;
}

// The angles at the centre, of sum 2 pi. Each is positive and less than pi, as the construction needs: in space an
// angle is at most the sum of the others, so it is at most half of the sum, and only rounding and zero edges break it.
std::vector<double> flattened_angles(const Vec3d& centre, std::span<const Vec3d> ring) {
  const std::size_t d = ring.size();
  std::vector<double> angle(d);
  for (std::size_t k = 0; k < d; ++k) {
    const Vec3d a = ring[k] - centre, b = ring[(k + 1) % d] - centre;
    const double na = norm(a), nb = norm(b);
    // atan2 of unit vectors: exact for small angles, where arccos is not, and no underflow for short edges.
    if (na > 0 && nb > 0) {
      const Vec3d u = a * (1 / na), v = b * (1 / nb);
      angle[k] = std::atan2(norm(cross(u, v)), dot(u, v));
    }
  }
  const double sum = std::accumulate(angle.begin(), angle.end(), 0.0);
  if (sum == 0) {
    std::fill(angle.begin(), angle.end(), 2 * std::numbers::pi / static_cast<double>(d));
    return angle;
  }
  const double least = degeneracy * sum / static_cast<double>(d), most = 0.5 * sum * (1 - degeneracy);
  for (double& a : angle) a = std::clamp(a, least, most);
  const double scale = 2 * std::numbers::pi / std::accumulate(angle.begin(), angle.end(), 0.0);
  for (double& a : angle) a *= scale;
  return angle;
}

FlatStar flatten(const Vec3d& centre, std::span<const Vec3d> ring) {
  FlatStar star{edge_lengths(centre, ring), std::vector<double>(ring.size() + 1, 0.0)};
  const std::vector<double> angle = flattened_angles(centre, ring);
  std::partial_sum(angle.begin(), angle.end(), star.direction.begin() + 1);
  return star;
}

// Twice the area of the triangle (centre, i, j), where j lies at `angle` from i, counter-clockwise.
double wedge(const FlatStar& star, std::size_t i, std::size_t j, double angle) {
  return star.radius[i] * star.radius[j] * std::max(std::sin(angle), 0.0);
}

} // namespace

std::vector<double> floater_weights(const Vec3d& centre, std::span<const Vec3d> ring) {
  using std::numbers::pi;
  const std::size_t d = ring.size();
  const FlatStar star = flatten(centre, ring);
  std::vector<double> weight(d, 0.0);
  // For each neighbour l the ray from l through the centre meets the ring between r and r + 1; r only moves forward.
  std::size_t turns = 0; // r = turns mod d, counted from neighbour 0
  for (std::size_t l = 0; l < d; ++l) {
    const auto angle_from_l = [&](std::size_t k) {
      const std::size_t turn = k / d;
      return star.direction[k % d] + 2 * pi * static_cast<double>(turn) - star.direction[l];
    };
    turns = std::max(turns, l + 1);
    while (turns + 2 < l + d && angle_from_l(turns + 1) <= pi) ++turns;
    const std::size_t r = turns % d, s = (turns + 1) % d;
    const double to_r = angle_from_l(turns), to_s = angle_from_l(turns + 1);
    // Barycentric coordinates of the centre in the triangle (l, r, s), as ratios of areas.
    const double bl = wedge(star, r, s, to_s - to_r), br = wedge(star, s, l, 2 * pi - to_s),
                 bs = wedge(star, l, r, to_r);
    const double share = 1 / (static_cast<double>(d) * (bl + br + bs));
    weight[l] += bl * share;
    weight[r] += br * share;
    weight[s] += bs * share;
  }
  return weight;
}

} // namespace orbis::sphere
