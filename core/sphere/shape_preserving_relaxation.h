// The paper's relaxation: always move the vertex that can be improved most, until no move is worth its while.
// The ratio ds(p*) / ds(p) of the paper orders the vertices; see shape_preserving_star.h for the energy.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/progress.h"
#include "core/sphere/shape_preserving_mesh.h"
#include "core/sphere/shape_preserving_star.h"

namespace orbis::sphere {

// Where a relaxation finds its stars: connectivity and weights.
class StarSource {
public:
  virtual ~StarSource() = default;
  // Sets `ring` and star.weight of vertex v. star's other members are left alone.
  virtual void gather(mesh::Index v, std::vector<mesh::Index>& ring, Star& star) const = 0;
};

// Equal weights on a mesh that changes (barycentric relaxation).
class EqualWeights final : public StarSource {
public:
  explicit EqualWeights(const HalfEdgeMesh& mesh) : mesh_(mesh) {}
  void gather(mesh::Index v, std::vector<mesh::Index>& ring, Star& star) const override;

private:
  const HalfEdgeMesh& mesh_;
};

// Floater's weights of the original surface, on its own connectivity, in flat arrays.
class FloaterWeights final : public StarSource {
public:
  FloaterWeights(const HalfEdgeMesh& mesh, const std::vector<Vec3d>& positions, Progress& progress);
  void gather(mesh::Index v, std::vector<mesh::Index>& ring, Star& star) const override;

private:
  std::vector<std::size_t> begin_; // ring of v: [begin_[v], begin_[v + 1]) of the arrays below
  std::vector<mesh::Index> ring_;
  std::vector<double> weight_;
};

// Vertices by ratio, smallest first, ties by number: a binary heap in which a vertex can be found.
class ImprovementQueue {
public:
  explicit ImprovementQueue(std::size_t vertices) : place_(vertices, absent) {}
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] mesh::Index top() const { return heap_.front().vertex; }
  void set(mesh::Index v, double ratio); // inserts or changes
  void erase(mesh::Index v);             // nothing where v is not in the queue

private:
  struct Entry {
    double ratio;
    mesh::Index vertex;
    auto operator<=>(const Entry&) const = default;
  };
  static constexpr std::uint32_t absent = ~std::uint32_t{0};

  void put(std::size_t at, Entry entry);
  void sift(std::size_t at, Entry entry); // puts entry where it belongs, starting from the hole `at`

  std::vector<Entry> heap_;
  std::vector<std::uint32_t> place_; // vertex -> index in heap_
};

class Relaxation {
public:
  // points: on the unit sphere, changed in place by run() and balance(). Only vertices that
  // were touched, and their neighbours, are looked at.
  // threshold: a move whose ratio is above it is not worth its while.
  Relaxation(const StarSource& source, std::vector<Vec3d>& points, double threshold, Progress& progress);

  // Triangles whose V is smaller push back (shape_preserving_star.h).
  void set_floor(double floor) { floor_ = floor; }
  // Finds v's best place anew: v, its neighbours or the floor changed.
  void touch(mesh::Index v);
  void touch_ring(mesh::Index v);
  void touch_all(std::span<const mesh::Index> vertices);
  // Moves vertices, best first, until none is worth its while or `budget` visits of neighbours are spent.
  // Returns whether none is worth its while.
  bool run(std::uint64_t budget);

  // Moebius maps that bring the mean of the points of `vertices` (all that are in use) to the centre of the sphere, or
  // as far as no triangle folds: they turn great circles into other circles, which large triangles may not survive.
  // Returns whether points moved; then all vertices are to be touched.
  bool balance(std::span<const mesh::Index> vertices);

  [[nodiscard]] std::uint64_t moves() const { return moves_; }
  [[nodiscard]] std::size_t waiting() const { return queue_.size(); } // vertices that can still be improved
  // The star of v as it is now; valid until the next call of a member.
  [[nodiscard]] const Star& star(mesh::Index v);
  [[nodiscard]] const std::vector<mesh::Index>& ring() const { return ring_; } // of the last star()

private:
  void touch_neighbour(mesh::Index v);
  [[nodiscard]] bool unfolded(std::span<const mesh::Index> vertices);
  void check_now_and_then(); // for cancellation

  const StarSource& source_;
  std::vector<Vec3d>& points_;
  double threshold_;
  // Where triangles are squeezed, a vertex moves for a tenth of the gain: to make room far away takes many moves that
  // each gain little, and stopping at 0.5 % leaves areas that fall by some 7 % from ring to ring of a limb.
  double fine_threshold_;
  double gain_; // of one Newton step, see best_place; well below what the threshold asks for
  Progress& progress_;
  double floor_ = 0;
  ImprovementQueue queue_;
  std::vector<Vec3d> place_;         // best place of each vertex in the queue
  std::vector<std::uint32_t> stale_; // neighbours that moved since a hub was evaluated last
  std::vector<std::uint32_t> valence_;
  std::uint64_t moves_ = 0, visits_ = 0, next_check_ = 0;
  Star star_;
  std::vector<mesh::Index> ring_, moved_ring_;
};

} // namespace orbis::sphere
