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

  // Weights of a place in the atlas on the corners of a triangle; not negative inside.
  [[nodiscard]] std::array<double, 3> weights_in(const mesh::Triangle& triangle, const Uv& uv) const;
  [[nodiscard]] Vec3d area_normal(const mesh::Triangle& triangle) const;
  // Whether a triangle is positively oriented on the sphere and oriented like `sign` in the atlas, exactly.
  [[nodiscard]] bool is_sound(const mesh::Triangle& triangle, int sign) const;
  [[nodiscard]] int atlas_orientation(const mesh::Triangle& triangle) const;

  // The sum of the deviations of `numbers`, each on the one of `triangles` that it lies in.
  [[nodiscard]] double energy(std::span<const std::uint32_t> numbers, std::span<const mesh::Triangle> triangles) const;
  // Divides the witnesses of some triangles anew among the same triangles, after these have changed.
  void sort_again(std::span<const std::uint32_t> triangles);

private:
  [[nodiscard]] std::size_t holder(const Uv& uv, std::span<const mesh::Triangle> triangles,
                                   std::array<double, 3>& weights) const;

  const FullSurface& full_;
  Level& level_;
  std::vector<Witness> witnesses_;
  std::vector<std::vector<std::uint32_t>> of_; // by triangle of the level
};

} // namespace orbis::lod
