// Sweeps of local Newton steps over the live vertices of one level of detail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/distortion_energy.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {

// Vertices in classes without neighbours among themselves: a class can be moved at once, in any order, with any number
// of threads, and gives the same bits.
struct Coloring {
  std::vector<mesh::Index> vertices; // class by class
  std::vector<std::uint32_t> first;  // class -> its first entry in vertices; one past the end too
  void build(std::span<const mesh::Index> live, const StarTable& stars);

private:
  std::vector<std::uint8_t> color_; // by vertex
};

// One level of detail: what the relaxation moves and what it measures against.
struct Level {
  std::span<const mesh::Index> vertices; // live
  const StarTable& stars;
  std::span<const Reference> references; // by slot
  const Coloring& coloring;
};

// Which vertices are worth another step.
using Active = std::vector<std::uint8_t>;

// One sweep: moves every active vertex once, class after class. A vertex that gains more than `worthwhile` of its
// star's energy stays active and wakes its neighbours; the others fall asleep. Returns the number of moves.
std::size_t relax_active(const Level& level, double worthwhile, std::span<Vec3d> points, Active& active,
                         mesh::ThreadPool& pool);

// The energy of the whole map: sum over all triangles of E, 4 pi where isometric, infinite where one is folded.
[[nodiscard]] double total_energy(std::span<const mesh::Triangle> triangles, std::span<const Reference> references,
                                  std::span<const Vec3d> points, mesh::ThreadPool& pool);

} // namespace orbis::sphere
