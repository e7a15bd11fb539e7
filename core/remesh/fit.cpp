#include "core/remesh/fit.h"

#include <algorithm>
#include <cmath>

#include "core/lod/triangle_tree.h"
#include "core/mesh/edges.h"
#include "core/texture/stars.h"

namespace orbis::remesh {
namespace {

constexpr int rounds = 4;
constexpr std::size_t grain = 1024;
constexpr double least_part = 0.1; // of the mean of the star, that a triangle keeps
constexpr std::size_t most_tries = 3;

// What the image should pass through: a point of the surface.
struct Target {
  Vec3d direction, position;
};

Vec3d on_surface(const MappedSurface& surface, const Place& place) {
  Vec3d p;
  for (std::size_t k = 0; k < 3; ++k)
    p += Vec3d(surface.positions[surface.triangles[place.triangle][k]]) * place.weights[k];
  return p;
}

// Half the mean length of the sampling's edges, all taken for equal: sqrt(area / (sqrt(3) / 4)) each.
double spacing_of(const SphereMesh& sampling) {
  constexpr double sphere = 12.566370614359172, equilateral = 0.4330127018922193;
  return 0.5 * std::sqrt(sphere / static_cast<double>(sampling.triangles.size()) / equilateral);
}

std::vector<Target> targets_on(const MappedSurface& surface, double spacing) {
  std::vector<Target> out;
  for (std::size_t v = 0; v < surface.points.size(); ++v)
    out.push_back({surface.points[v], Vec3d(surface.positions[v])});
  const mesh::EdgeTable edges(surface.triangles, surface.points.size());
  edges.for_each([&](mesh::Index a, mesh::Index b, std::span<const mesh::EdgeSide>) {
    const auto parts = static_cast<int>(norm(surface.points[b] - surface.points[a]) / spacing);
    for (int i = 1; i < parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      out.push_back({normalized(surface.points[a] * (1 - t) + surface.points[b] * t),
                     Vec3d(surface.positions[a]) * (1 - t) + Vec3d(surface.positions[b]) * t});
    }
  });
  return out;
}

class Fitter {
public:
  Fitter(SphereMesh& sampling, const MappedSurface& surface, const SphereTree& tree, mesh::ThreadPool& pool)
      : sampling_(sampling), surface_(surface), tree_(tree), pool_(pool),
        stars_(sampling.triangles, sampling.points.size()), targets_(targets_on(surface, spacing_of(sampling))),
        over_(targets_.size()), image_(sampling.points.size()), in_(sampling.triangles.size()) {}

  void run(Progress& progress) {
    pool_.for_blocks(image_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) image_[v] = on_surface(surface_, tree_.locate(sampling_.points[v]));
    });
    for (int round = 0; round < rounds; ++round) {
      progress.check();
      place_targets();
      std::uint64_t moves = 0;
      for (const auto& [distance, v] : worst_vertices()) moves += improve(v) ? 1 : 0;
      if (moves == 0) break;
    }
  }

private:
  // Which triangle of the sampling each target lies over.
  void place_targets() {
    const SphereTree tree(sampling_.points, sampling_.triangles);
    pool_.for_blocks(targets_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) over_[i] = tree.locate(targets_[i].direction).triangle;
    });
    for (auto& list : in_) list.clear();
    for (std::uint32_t i = 0; i < targets_.size(); ++i) in_[over_[i]].push_back(i);
  }

  [[nodiscard]] double squared_distance(std::uint32_t target, std::uint32_t triangle) const {
    const auto& [a, b, c] = sampling_.triangles[triangle];
    return lod::squared_distance(targets_[target].position, image_[a], image_[b], image_[c]);
  }

  // Vertices whose stars hold a target that is off by more than the root mean square of all; the farthest first.
  [[nodiscard]] std::vector<std::pair<double, mesh::Index>> worst_vertices() const {
    std::vector<double> most(sampling_.points.size());
    double sum = 0;
    for (std::uint32_t i = 0; i < targets_.size(); ++i) {
      const double d = squared_distance(i, over_[i]);
      sum += d;
      for (const mesh::Index v : sampling_.triangles[over_[i]]) most[v] = std::max(most[v], d);
    }
    const double mean = sum / static_cast<double>(targets_.size());
    std::vector<std::pair<double, mesh::Index>> out;
    for (mesh::Index v = 0; v < most.size(); ++v)
      if (most[v] > mean) out.emplace_back(most[v], v);
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    return out;
  }

  // Six times the volume over the centre: positive where the triangle is positively oriented.
  [[nodiscard]] double volume(std::uint32_t t) const {
    const auto& [a, b, c] = sampling_.triangles[t];
    const Vec3d& p = sampling_.points[a];
    return dot(p, cross(sampling_.points[b] - p, sampling_.points[c] - p));
  }

  [[nodiscard]] bool is_sound(std::span<const std::uint32_t> star) const {
    double sum = 0, least = volume(star[0]);
    for (const std::uint32_t t : star) {
      sum += volume(t);
      least = std::min(least, volume(t));
    }
    return least > 0 && least > least_part * sum / static_cast<double>(star.size());
  }

  // The triangle of the star that a direction lies deepest in.
  [[nodiscard]] std::uint32_t triangle_in(std::span<const std::uint32_t> star, const Vec3d& d) const {
    std::uint32_t best = star[0];
    double depth = -1e300;
    for (const std::uint32_t t : star) {
      double least = 1e300;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d &a = sampling_.points[sampling_.triangles[t][k]],
                    &b = sampling_.points[sampling_.triangles[t][(k + 1) % 3]];
        least = std::min(least, dot(d, cross(a - d, b - d)));
      }
      if (least <= depth) continue;
      depth = least;
      best = t;
    }
    return best;
  }

  // Tries the star's worst targets as places of its centre.
  bool improve(mesh::Index v) {
    std::vector<std::uint32_t> star;
    for (const texture::StarCorner& corner : stars_[v]) star.push_back(corner.corner / 3);
    std::vector<std::pair<double, std::uint32_t>> around; // distance, target
    double before = 0;
    for (const std::uint32_t t : star) {
      for (const std::uint32_t i : in_[t]) {
        const double d = squared_distance(i, t);
        before += d * d;
        around.emplace_back(d, i);
      }
    }
    std::sort(around.begin(), around.end(), std::greater<>());
    for (std::size_t i = 0; i < std::min(around.size(), most_tries); ++i)
      if (try_at(v, star, around, targets_[around[i].second], before)) return true;
    return false;
  }

  bool try_at(mesh::Index v, std::span<const std::uint32_t> star,
              std::span<const std::pair<double, std::uint32_t>> around, const Target& there, double before) {
    const Vec3d old_point = sampling_.points[v], old_image = image_[v];
    sampling_.points[v] = there.direction;
    image_[v] = there.position;
    double after = 0;
    std::vector<std::uint32_t> over;
    if (is_sound(star)) {
      for (const auto& [distance, i] : around) {
        over.push_back(triangle_in(star, targets_[i].direction));
        const double d = squared_distance(i, over.back());
        after += d * d;
        if (after >= before) break;
      }
    }
    if (over.size() < around.size() || after >= before) {
      sampling_.points[v] = old_point;
      image_[v] = old_image;
      return false;
    }
    for (const std::uint32_t t : star) in_[t].clear();
    for (std::size_t i = 0; i < around.size(); ++i) in_[over_[around[i].second] = over[i]].push_back(around[i].second);
    return true;
  }

  SphereMesh& sampling_;
  const MappedSurface& surface_;
  const SphereTree& tree_;
  mesh::ThreadPool& pool_;
  texture::Stars stars_;
  std::vector<Target> targets_;
  std::vector<std::uint32_t> over_;            // target -> triangle of the sampling
  std::vector<Vec3d> image_;                   // vertex of the sampling -> its place on the surface
  std::vector<std::vector<std::uint32_t>> in_; // triangle of the sampling -> targets
};

} // namespace

void fit_to_surface(SphereMesh& sampling, const MappedSurface& surface, const SphereTree& tree, mesh::ThreadPool& pool,
                    Progress& progress) {
  Fitter(sampling, surface, tree, pool).run(progress);
}

} // namespace orbis::remesh
