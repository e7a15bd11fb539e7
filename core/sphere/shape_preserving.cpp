// H. Birkholz, "Shape-Preserving Parametrization of Genus 0 Surfaces" (2004), made safe at any size.
//
//   t1 simplify  half-edge collapses, shortest edge first, to a tetrahedron
//   t2 refine    the tetrahedron on the sphere, collapses undone in reverse order, barycentric relaxation after each
//   t3 optimise  the same relaxation with Floater's shape-preserving weights
//
// The paper's method, its energy, its weights, its order of moves and its thresholds are kept. What differs, and why:
//
//  * Recentring. The energy ds is least when the whole map shrinks to a point, and on the way there half of the sphere
//    fills with a few huge triangles and the vertices crowd in the other half. Moebius maps are the directions in which
//    that happens almost for free. After an insertion (each one while the mesh is small, then each 2 % of growth) one
//    brings the mean of the points back to the centre. Without it an even sphere of 5,000 triangles came out with a
//    "Minimum" of 10.3 and areas down to 0.005 of the mean; with it 15.15 and 0.48. (A low "Minimum" is a bad sign.)
//  * A barrier. Thin limbs still shrink exponentially with their length, as in every map that keeps angles. A triangle
//    whose area falls below 1 % of the mean at that level pushes back (shape_preserving_star.h); where no triangle
//    does, the energy is exactly the paper's. Measured: the vertices of a limb stay 0.03 of the mean edge apart or
//    more. On the first two dozen vertices the limit is 10 %, as their triangles would slide to great circles
//    otherwise. Should a triangle still be too thin to keep its orientation in float32, the limit is raised. Vertices
//    among triangles far below that limit move for a tenth of the gain that the threshold asks for.
//  * A move that would fold a triangle is shortened until it does not, where the paper leaves it out.
//  * A new vertex goes at once from its parent's place to a point that sees its whole ring (insertion_place): there
//    always is one.
//  * Edges whose lengths agree to 0.03 % are collapsed in a scattered order, not in that of the file: a regular tube
//    that is eaten up from one end grows back from that end, faster than the relaxation can push the rest away.
//  * The work is bounded: per insertion, and per stage. What one insertion leaves over stays in the queue for the next,
//    and the bound of an insertion bites in about one of a hundred. Embedding::converged tells of the bound of a stage.
//
// Tried and dropped: the barrier alone, without recentring (a floor of 10 % of the mean area was needed, and gave limbs
// a "Minimum" of 20 to 27); sweeps over all vertices after each recentring (no difference).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/mesh/unit_positions.h"
#include "core/sphere/embedding.h"
#include "core/sphere/shape_preserving_mesh.h"
#include "core/sphere/shape_preserving_placement.h"
#include "core/sphere/shape_preserving_relaxation.h"

namespace orbis::sphere {
namespace {

using mesh::Index;

constexpr double barycentric_threshold = 0.995; // of the refinement; the paper's 0.5 %
constexpr double least_area = 0.01;             // of the mean triangle: where the barrier begins
constexpr double least_coarse_area = 0.1;       // the same up to coarse_mesh vertices; between, by 1 / n^2
constexpr double coarse_mesh = 24;
constexpr std::uint64_t visits_per_insertion = 10'000; // of neighbours, some 200 moves
constexpr std::uint64_t visits_per_round = 100;        // of each vertex, some 2 moves
constexpr int raises = 3;                              // of the barrier by 4, if triangles are too thin to round
constexpr int rounds = 20;                             // at the end of a stage
constexpr std::size_t small_mesh = 50;                 // vertices; recentred after each insertion
constexpr std::size_t report_every = 256;              // insertions

class Stopwatch {
public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// V where the barrier begins. V is twice a triangle's area to first order; 2 n - 4 triangles share 4 pi.
double barrier_floor(std::size_t vertices) {
  const double n = static_cast<double>(vertices), coarse = std::min(1.0, coarse_mesh * coarse_mesh / (n * n));
  return std::max(least_area, least_coarse_area * coarse) * 4 * std::numbers::pi / (n - 2);
}

// Recentres the map and looks at all vertices anew. Returns whether it was off centre.
bool recentre(Relaxation& relaxation, std::span<const Index> vertices) {
  const bool moved = relaxation.balance(vertices);
  relaxation.touch_all(vertices);
  return moved;
}

// Relaxes until no move is worth its while on a map that is centred, or the work of a stage is done; returns which. The
// recentrings come between, for the long way to the minimum leads off centre. after_round is called now and then.
template <class F> bool settle(Relaxation& relaxation, std::span<const Index> vertices, F after_round) {
  bool settled = false;
  for (int round = 0; round < rounds; ++round) {
    if (!recentre(relaxation, vertices) && settled) return true;
    settled = relaxation.run(visits_per_round * vertices.size());
    after_round();
  }
  return settled;
}

// The mesh grows from the tetrahedron to the surface, and its map with it.
class Refinement {
public:
  Refinement(HalfEdgeMesh& surface, std::vector<Vec3d>& points, Progress& progress)
      : surface_(surface), points_(points), weights_(surface),
        relaxation_(weights_, points, barycentric_threshold, progress) {
    for (const auto v : surface.vertices())
      if (!surface.status(v).deleted()) live_.push_back(static_cast<Index>(v.idx()));
    std::vector<Index> ring;
    one_ring(surface, live_.front(), ring);
    const auto corner = regular_tetrahedron();
    points[live_.front()] = corner[0];
    for (std::size_t k = 0; k < 3; ++k) points[ring[k]] = corner[k + 1];
  }

  void insert(const Collapse& collapse) {
    split_vertex(surface_, collapse);
    live_.push_back(collapse.removed);
    relaxation_.set_floor(barrier_floor(live_.size()));
    place(collapse);
    if (live_.size() >= recentre_at_) {
      recentre(relaxation_, live_);
      recentre_at_ = live_.size() + 1 + (live_.size() < small_mesh ? 0 : live_.size() / 50);
    } else {
      relaxation_.touch(collapse.removed);
      relaxation_.touch_ring(collapse.removed);
    }
    relaxation_.run(visits_per_insertion);
  }

  // Returns whether no move is worth its while any more.
  bool finish() {
    return settle(relaxation_, live_, [] {});
  }

  [[nodiscard]] std::uint64_t moves() const { return relaxation_.moves(); }

private:
  void place(const Collapse& c) {
    points_[c.removed] = points_[c.parent];
    const Star& star = relaxation_.star(c.removed);
    const std::vector<Index>& ring = relaxation_.ring();
    const auto in_ring = [&](Index v) {
      return static_cast<std::size_t>(std::find(ring.begin(), ring.end(), v) - ring.begin());
    };
    const double floor = barrier_floor(live_.size());
    const Vec3d point = insertion_place(star, in_ring(c.parent), in_ring(c.left), in_ring(c.right), floor);
    if (!std::isfinite(star_energy(star, point, floor)))
      throw Error(ErrorCode::not_certified, "a vertex found no place on the sphere without folding a triangle");
    points_[c.removed] = point;
  }

  HalfEdgeMesh& surface_;
  std::vector<Vec3d>& points_;
  EqualWeights weights_;
  Relaxation relaxation_;
  std::vector<Index> live_;
  std::size_t recentre_at_ = 5;
};

// Relaxes with Floater's weights. Reports how many vertices need no more moves: the most so far.
bool optimise(Relaxation& relaxation, const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& points,
              Progress& progress) {
  const std::size_t vertices = points.size();
  std::vector<Index> all(vertices);
  std::iota(all.begin(), all.end(), Index{0});
  std::size_t at_rest = 0;
  const auto report = [&] {
    at_rest = std::max(at_rest, vertices - relaxation.waiting());
    progress.report(Stage::optimise, at_rest, vertices);
  };
  double floor = barrier_floor(vertices);
  relaxation.set_floor(floor);
  bool settled = settle(relaxation, all, report);
  for (int i = 0; i < raises && !survives_rounding(mesh.triangles, points); ++i) {
    floor *= 4;
    relaxation.set_floor(floor);
    settled = settle(relaxation, all, report);
  }
  progress.report(Stage::optimise, vertices, vertices);
  return settled;
}

} // namespace

Embedding embed_shape_preserving(const mesh::TriangleMesh& mesh, double threshold, Progress& progress) {
  Embedding out;
  Stopwatch simplifying;
  const std::vector<Vec3d> positions = mesh::unit_positions(mesh);
  HalfEdgeMesh surface = make_half_edge_mesh(mesh, positions, progress);
  const std::vector<Collapse> collapses = collapse_to_tetrahedron(surface, progress);
  out.t1_ms = simplifying.milliseconds();

  Stopwatch refining;
  out.points.resize(positions.size());
  Refinement refinement(surface, out.points, progress);
  for (std::size_t i = collapses.size(); i-- > 0;) {
    refinement.insert(collapses[i]);
    if (i % report_every == 1) progress.report(Stage::refine, collapses.size() - i, collapses.size());
  }
  const bool barycentric = refinement.finish();
  progress.report(Stage::refine, collapses.size(), collapses.size());
  out.t2_ms = refining.milliseconds();

  Stopwatch optimising;
  const FloaterWeights weights(surface, positions, progress);
  Relaxation relaxation(weights, out.points, threshold, progress);
  const bool shape_preserving = optimise(relaxation, mesh, out.points, progress);
  out.t3_ms = optimising.milliseconds();
  out.relaxations = refinement.moves() + relaxation.moves();
  out.converged = barycentric && shape_preserving;
  return out;
}

double shape_preserving_energy(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  NoProgress progress;
  const std::vector<Vec3d> positions = mesh::unit_positions(mesh);
  const HalfEdgeMesh surface = make_half_edge_mesh(mesh, positions, progress);
  const FloaterWeights weights(surface, positions, progress);
  double sum = 0;
  Star star;
  std::vector<Index> ring;
  for (Index v = 0; v < points.size(); ++v) {
    weights.gather(v, ring, star);
    star.ring.clear();
    for (const Index u : ring) star.ring.push_back(points[u]);
    sum += angle_energy(star, points[v]);
  }
  return sum;
}

} // namespace orbis::sphere
