// A level that is being refined: its triangles, and which points of the full surface each of them stands for.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lod/full_surface.h"
#include "core/lod/simplify.h"

namespace orbis::lod {

// A point of the full surface, and how much a deviation there counts.
struct Witness {
  Uv uv{};
  Vec3d position, normal; // scaled as in FullSurface; unit
  FullSurface::Weighing weighing;

  // The quadric of deviation_quadric.h for a level that has its point of this texel at p.
  [[nodiscard]] double deviation(const Vec3d& p) const;
};

// Weights of places in the atlas on the corners of a triangle; not negative inside. A triangle without area there gives
// no numbers.
class AtlasTriangle {
public:
  AtlasTriangle(const Vec2f& a, const Vec2f& b, const Vec2f& c) : x_(a.x), y_(a.y) {
    const double bx = b.x - x_, by = b.y - y_, cx = c.x - x_, cy = c.y - y_, scale = 1 / (bx * cy - by * cx);
    second_ = {cy * scale, -cx * scale};
    third_ = {-by * scale, bx * scale};
  }
  [[nodiscard]] std::array<double, 3> weights(const Uv& uv) const {
    const double x = uv[0] - x_, y = uv[1] - y_;
    const double second = second_[0] * x + second_[1] * y, third = third_[0] * x + third_[1] * y;
    return {1 - second - third, second, third};
  }

private:
  double x_, y_;
  std::array<double, 2> second_{}, third_{};
};

// A witness, and the triangle that it was last seen in: its number among those that are looked at.
struct Held {
  std::uint32_t witness = 0, triangle = 0;
};

class Draft {
public:
  // The centroids of the full surface's triangles are the witnesses, some dozens for each triangle of the level where
  // there are so many. Both outlive the draft.
  Draft(const FullSurface& full, Level& level);

  [[nodiscard]] const FullSurface& full() const { return full_; }
  [[nodiscard]] Level& level() const { return level_; }
  [[nodiscard]] const Witness& witness(std::uint32_t number) const { return witnesses_[number]; }
  [[nodiscard]] std::vector<std::uint32_t>& witnesses_of(std::uint32_t triangle) { return of_[triangle]; }

  // By vertex, scaled: what the level's positions become with write_positions().
  std::vector<Vec3d> positions;
  void write_positions();

  [[nodiscard]] AtlasTriangle in_atlas(const mesh::Triangle& triangle) const {
    const auto& v = level_.mesh.vertices;
    return {v[triangle[0]].uv, v[triangle[1]].uv, v[triangle[2]].uv};
  }
  [[nodiscard]] Vec3d area_normal(const mesh::Triangle& triangle) const;
  // Whether a triangle is positively oriented on the sphere and oriented like `sign` in the atlas, exactly.
  [[nodiscard]] bool is_sound(const mesh::Triangle& triangle, int sign) const;
  [[nodiscard]] int atlas_orientation(const mesh::Triangle& triangle) const;

  // The witnesses of some triangles, each with the place of its triangle in that list.
  void collect(std::span<const std::uint32_t> triangles, std::vector<Held>& out) const;
  // The sum of the deviations of `held`, each on the one of `triangles` that it lies in now; says which.
  [[nodiscard]] double energy(std::span<Held> held, std::span<const mesh::Triangle> triangles);
  // Hands the witnesses of some triangles to those that hold them after the last call of energy().
  void hand_over(std::span<const Held> held, std::span<const std::uint32_t> triangles);

private:
  const FullSurface& full_;
  Level& level_;
  std::vector<Witness> witnesses_;
  std::vector<std::vector<std::uint32_t>> of_; // by triangle of the level
  std::vector<AtlasTriangle> in_atlas_;        // of the triangles that energy() looks at
};

} // namespace orbis::lod
