// Sweeps of local Newton steps over the vertices of one level of detail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/sphere/distortion_energy.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {

// In which order a sweep visits the vertices, so that no thread reads what another writes and the result is the same
// bits with any number of threads. Consecutive vertices form blocks. First all blocks are swept side by side, each in
// the order of its vertices: those whose neighbours all lie in the block. What is left lies at the blocks' borders, and
// is divided into classes without neighbours among themselves, which are moved one after the other.
class SweepOrder {
public:
  static constexpr std::size_t block_size = 2048;

  void build(const StarTable& stars, mesh::ThreadPool& pool);

  [[nodiscard]] bool is_at_border(mesh::Index v) const { return at_border_[v] != 0; }
  [[nodiscard]] std::size_t classes() const { return first_.size() - 1; }
  [[nodiscard]] std::span<const mesh::Index> members(std::size_t c) const {
    return std::span(border_).subspan(first_[c], first_[c + 1] - first_[c]);
  }

private:
  void color(const StarTable& stars, std::span<const mesh::Index> border);

  std::vector<std::uint8_t> at_border_; // by vertex
  std::vector<mesh::Index> border_;     // class by class
  std::vector<std::uint32_t> first_;    // class -> its first entry in border_; one past the end too
  std::vector<std::uint8_t> color_;     // by vertex
};

// One level of detail: what the relaxation moves and what it measures against.
struct Level {
  const StarTable& stars;
  std::span<const Reference> references; // by triangle
  const SweepOrder& order;
};

// Which vertices are worth another step.
using Active = std::vector<std::uint8_t>;

// One sweep: moves every active vertex once. A vertex that gains more than `worthwhile` of its star's energy stays
// active and wakes its neighbours; the others fall asleep. Returns the number of moves.
std::size_t relax_active(const Level& level, const TriangleEnergy& energy, double worthwhile, std::span<Vec3d> points,
                         Active& active, mesh::ThreadPool& pool);

// The energy of the whole map: sum over all triangles of E, 4 pi where isometric, infinite where one is folded.
[[nodiscard]] double total_energy(const TriangleEnergy& energy, std::span<const mesh::Triangle> triangles,
                                  std::span<const Reference> references, std::span<const Vec3d> points,
                                  mesh::ThreadPool& pool);

} // namespace orbis::sphere
