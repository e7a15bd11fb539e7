// An energy of triangle_energy.h (by default the symmetric Dirichlet energy), minimised on a hierarchy (method in
// docs/parametrization.md).
//
// The mesh is taken apart in rounds of independent vertex removals. From the tetrahedron on, each round's vertices are
// put back at once, every one into the kernel of its polygon, and the level is relaxed by sweeps of local Newton steps.
// A vertex whose step gains little falls asleep until a neighbour's move wakes it, so the work goes where the map is
// bad. Low frequencies move on coarse levels, where a sweep costs little.
//
// Local steps hardly move low frequencies: a limb that got too little of the sphere keeps too little. So on levels each
// about twice as large as the last, Newton's method moves all vertices together, with a sparse factorisation
// (newton_level.h), until little is left to gain. Most surfaces need that on small levels only, where it costs little;
// those with long limbs on all. On the finest level Newton steps with conjugate gradients (global_step.h) take away
// what is left.
//
// Everything is done in an order that does not depend on the number of threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/mesh/spatial_order.h"
#include "core/mesh/unit_positions.h"
#include "core/sphere/embedding.h"
#include "core/sphere/global_step.h"
#include "core/sphere/hierarchical_basis.h"
#include "core/sphere/hierarchy.h"
#include "core/sphere/insertion.h"
#include "core/sphere/level_mesh.h"
#include "core/sphere/moebius_centring.h"
#include "core/sphere/newton_level.h"
#include "core/sphere/relaxation.h"

namespace orbis::sphere {
namespace {

using mesh::Index;

constexpr std::size_t insertion_grain = 512, copy_grain = 8192;

// Coarse levels have slivers that the surface does not have: their shapes are rounded off. The finest level is taken as
// it is, but for triangles without area.
constexpr double coarse_regularisation = 0.05;
constexpr double fine_regularisation = 1e-6;
// Sweeps a level: many where the level is small and the sweeps decide where the limbs go, few where it is large.
constexpr double sweep_budget = 20'000; // vertices times sweeps
constexpr double fewest_sweeps = 8, most_sweeps = 50;
// A step is worthwhile where it gains this part of the star's energy; less on levels of fewer than 2,000 vertices.
constexpr double worthwhile_gain = 0.01, smallest_gain = 1e-4, small_level = 2'000;
// At the end of a stage, over ever fewer vertices.
constexpr std::uint32_t final_sweeps = 200;
constexpr double final_gain = 0.003;

// Levels that Newton's method with a factorisation relaxes are at least so large, and so many times as large as the
// last one; where the first step on a level promised more than `hard`, the next is not so much larger, and the finest
// is one of them.
constexpr std::size_t smallest_newton_level = 64;
constexpr double level_growth = 2, hard_level_growth = 1.5;
constexpr double hard = 5e-3;
// Sweeps after a step, for the vertices that it brought close to a fold.
constexpr std::uint32_t mending_sweeps = 20;
constexpr double mending_gain = 1e-3;

struct Effort {
  // With a factorisation: levels up to so many vertices, up to so many where the last such level was hard, or up to
  // this part of the surface's vertices; at most so many steps a level, ending where a step promises less than this
  // part of the energy.
  std::size_t usual_level, hard_level;
  double part_of_surface;
  int newton_steps;
  double promise;
  // With conjugate gradients, on the finest level of at most so many vertices: at most so many steps, of so many
  // iterations each, ending where one gains less than `enough`.
  std::size_t largest;
  int steps;
  std::uint32_t iterations;
  double enough;
};

constexpr Effort effort_of(Quality quality) {
  switch (quality) {
  case Quality::draft:
    return {1'000, 4'000, 1.0 / 240, 1, 1e-3, 0, 0, 0, 0};
  case Quality::standard:
    return {2'000, 27'000, 1.0 / 60, 6, 1e-3, 1'000'000, 8, 8, 1e-2};
  case Quality::high:
    break;
  }
  return {16'000, 250'000, 1.0 / 20, 20, 1e-4, std::numeric_limits<std::size_t>::max(), 60, 60, 2e-4};
}

// The stretch alone does not keep triangles from growing: on coarse levels that leads into minima that finer ones do
// not get out of. So the map grows by the symmetric Dirichlet energy, and takes to the stretch at the end.
TriangleEnergy energy_of_growth(const TriangleEnergy& target) {
  return std::holds_alternative<Stretch>(target) ? SymmetricDirichlet{} : target;
}

class Refinement {
public:
  Refinement(const TriangleEnergy& energy, Hierarchy hierarchy, std::vector<Vec3d> positions, const Effort& effort,
             mesh::ThreadPool& pool);
  void refine(Progress& progress, Checkpoints& checkpoints);
  void optimise(Progress& progress);
  [[nodiscard]] std::vector<Vec3d> points() && { return std::move(points_); }
  std::uint64_t relaxations = 0;
  bool converged = true;

private:
  void insert_round(std::size_t round);
  void keep(std::size_t round, Checkpoints& checkpoints) const;
  [[nodiscard]] std::size_t take_up(const Checkpoints& checkpoints);
  [[nodiscard]] bool insert(std::size_t removal);
  void relax_level(std::uint32_t sweeps, double worthwhile, Progress& progress);
  void keep_stiffness(std::size_t round);
  // Sweeps over what is active, all at first. Returns whether no step is worthwhile any more.
  bool relax(std::uint32_t sweeps, double worthwhile, std::span<Vec3d> points, Progress& progress);
  void centre(std::span<Vec3d> points);
  [[nodiscard]] int global_steps() const { return points_.size() <= effort_.largest ? effort_.steps : 0; }
  [[nodiscard]] bool wants_newton(std::size_t vertices) const;
  void relax_by_newton(std::span<Vec3d> points, Progress& progress);
  [[nodiscard]] WholeLevel whole_level() const {
    return {energy_, level_.triangles(), level_.stars(), level_.references()};
  }

  TriangleEnergy target_; // of the finest level
  TriangleEnergy energy_; // on the way there
  Hierarchy hierarchy_;
  std::vector<Vec3d> positions_; // of the surface
  Effort effort_;
  mesh::ThreadPool& pool_;
  std::vector<Vec3d> points_; // on the sphere
  LevelMesh level_;
  std::vector<Vec3d> level_points_;
  SweepOrder order_;
  Active active_;
  HierarchicalBasis basis_;
  std::size_t last_newton_level_ = 0; // its vertices
  bool needed_convex_ = false;        // there
  double promise_ = 1;                // of the first step there, or half of what it was before
};

Refinement::Refinement(const TriangleEnergy& energy, Hierarchy hierarchy, std::vector<Vec3d> positions,
                       const Effort& effort, mesh::ThreadPool& pool)
    : target_(energy), energy_(energy_of_growth(energy)), hierarchy_(std::move(hierarchy)),
      positions_(std::move(positions)), effort_(effort), pool_(pool), points_(positions_.size()), level_(hierarchy_),
      basis_(hierarchy_, pool) {
  const mesh::Triangle& t = hierarchy_.triangles[hierarchy_.tetrahedron_slots[0]];
  Index apex = 0;
  for (const Index v : hierarchy_.tetrahedron) {
    if (v != t[0] && v != t[1] && v != t[2]) apex = v;
  }
  // The regular tetrahedron, its first face counter-clockwise seen from outside.
  const double h = std::sqrt(8.0) / 3, w = std::sqrt(2.0 / 3);
  points_[apex] = {0, 0, 1};
  points_[t[0]] = {h, 0, -1.0 / 3};
  points_[t[1]] = {-h / 2, -w, -1.0 / 3};
  points_[t[2]] = {-h / 2, w, -1.0 / 3};
}

bool Refinement::insert(std::size_t removal) {
  std::array<Vec3d, most_ring_vertices> polygon;
  const std::span<const Index> ring = hierarchy_.ring(removal);
  for (std::size_t k = 0; k < ring.size(); ++k) polygon[k] = points_[ring[k]];
  const std::optional<Vec3d> place = point_in_kernel(std::span(polygon).first(ring.size()));
  if (place) points_[hierarchy_.removed[removal]] = *place;
  return place.has_value();
}

void Refinement::insert_round(std::size_t round) {
  const std::uint32_t first = hierarchy_.round_first[round], end = hierarchy_.round_first[round + 1];
  // No two vertices of a round touch the same triangle, nor is one in another's ring.
  std::atomic<bool> all_placed = true;
  pool_.for_blocks(end - first, insertion_grain, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = first + from; i < first + to; ++i) {
      if (!insert(i)) all_placed = false;
      hierarchy_.undo(i);
    }
  });
  if (!all_placed) {
    throw Error(ErrorCode::not_certified, "a vertex found no place on the sphere that sees its whole ring");
  }
  level_.add_round(hierarchy_, round);
}

bool Refinement::relax(std::uint32_t sweeps, double worthwhile, std::span<Vec3d> points, Progress& progress) {
  active_.assign(points.size(), 1);
  for (std::uint32_t i = 0; i < sweeps; ++i) {
    progress.check();
    const std::size_t moves =
        relax_active({level_.stars(), level_.references(), order_}, energy_, worthwhile, points, active_, pool_);
    relaxations += moves;
    if (moves == 0) return true;
  }
  return false;
}

// Conformal maps alone are free to: the other energies say themselves where room is needed.
void Refinement::centre(std::span<Vec3d> points) {
  const auto* family = std::get_if<AreaWeighted>(&energy_);
  if (family == nullptr || family->theta > 0) return;
  centre_by_moebius(level_.triangles(), level_.references(), points, pool_);
}

bool Refinement::wants_newton(std::size_t vertices) const {
  const bool was_hard = promise_ > hard, finest = vertices == points_.size();
  const double growth = !was_hard ? level_growth : finest ? 1 : hard_level_growth;
  const auto part = static_cast<std::size_t>(effort_.part_of_surface * static_cast<double>(points_.size()));
  return vertices >= smallest_newton_level &&
         vertices <= std::max(was_hard ? effort_.hard_level : effort_.usual_level, part) &&
         static_cast<double>(vertices) >= growth * static_cast<double>(last_newton_level_);
}

void Refinement::relax_by_newton(std::span<Vec3d> points, Progress& progress) {
  const WholeLevel level = whole_level();
  NewtonLevel newton(level, needed_convex_, pool_);
  // The finest level has no other after it, and the shapes of its triangles are not rounded off.
  const int most_steps = points.size() == points_.size() ? 2 * effort_.newton_steps : effort_.newton_steps;
  for (int i = 0; i < most_steps; ++i) {
    progress.check();
    const double promise = newton.take(points);
    if (i == 0) promise_ = std::clamp(promise, promise_ / 2, 1.0); // the model may promise more than there is
    relax(mending_sweeps, mending_gain, points, progress);
    if (promise < effort_.promise) break;
  }
  last_newton_level_ = points.size();
  needed_convex_ = newton.needed_convex();
}

void Refinement::relax_level(std::uint32_t sweeps, double worthwhile, Progress& progress) {
  const std::span<const Index> vertices = level_.vertices();
  level_points_.resize(vertices.size());
  pool_.for_blocks(vertices.size(), copy_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) level_points_[i] = points_[vertices[i]];
  });
  relax(sweeps, worthwhile, level_points_, progress);
  if (wants_newton(vertices.size())) relax_by_newton(level_points_, progress);
  centre(level_points_);
  pool_.for_blocks(vertices.size(), copy_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points_[vertices[i]] = level_points_[i];
  });
}

// What the rounds that follow depend on, once the level of `round` is relaxed.
void Refinement::keep(std::size_t round, Checkpoints& checkpoints) const {
  StateWriter state;
  state.value(std::uint64_t{points_.size()});
  state.value(std::uint64_t{round});
  state.value(relaxations);
  state.value(std::uint64_t{last_newton_level_});
  state.value(needed_convex_);
  state.value(promise_);
  state.values(std::span<const Vec3d>(level_points_));
  if (global_steps() > 0) basis_.write_stiffness(level_.vertices(), state);
  checkpoints.keep(state.bytes());
}

// Returns the round whose level is relaxed, or the number of rounds where nothing is.
std::size_t Refinement::take_up(const Checkpoints& checkpoints) {
  StateReader state(checkpoints.kept());
  const auto vertices = state.value<std::uint64_t>(), kept_round = state.value<std::uint64_t>();
  if (!state.ok() || vertices != points_.size() || kept_round >= hierarchy_.rounds()) return hierarchy_.rounds();
  relaxations = state.value<std::uint64_t>();
  last_newton_level_ = state.value<std::uint64_t>();
  needed_convex_ = state.value<bool>();
  promise_ = state.value<double>();
  for (std::size_t round = hierarchy_.rounds(); round-- > kept_round;) {
    for (std::uint32_t i = hierarchy_.round_first[round]; i < hierarchy_.round_first[round + 1]; ++i)
      hierarchy_.undo(i);
    level_.add_round(hierarchy_, round);
  }
  for (const Index v : level_.vertices()) points_[v] = state.value<Vec3d>();
  if (global_steps() > 0) basis_.read_stiffness(level_.vertices(), state);
  if (!state.ok()) throw Error(ErrorCode::internal, "the checkpoint of an interrupted run is cut off");
  return kept_round;
}

void Refinement::refine(Progress& progress, Checkpoints& checkpoints) {
  std::size_t round = take_up(checkpoints);
  progress.report(Stage::refine, level_.vertices().size(), points_.size());
  while (round-- > 0) {
    insert_round(round);
    level_.build(hierarchy_, positions_, round == 0 ? fine_regularisation : coarse_regularisation, pool_);
    order_.build(level_.stars(), pool_);
    const auto live = static_cast<double>(level_.vertices().size());
    relax_level(static_cast<std::uint32_t>(std::clamp(sweep_budget / live, fewest_sweeps, most_sweeps)),
                std::clamp(worthwhile_gain * live / small_level, smallest_gain, worthwhile_gain), progress);
    if (global_steps() > 0) keep_stiffness(round);
    if (checkpoints.due()) keep(round, checkpoints);
    progress.report(Stage::refine, level_.vertices().size(), points_.size());
  }
}

// Of the tetrahedron with the first round, later of the round's vertices: at the level that they were inserted at.
void Refinement::keep_stiffness(std::size_t round) {
  const std::uint32_t begin = hierarchy_.round_first[round], end = hierarchy_.round_first[round + 1];
  const auto keep = [&](std::span<const Index> vertices, const auto& energy) {
    pool_.for_blocks(vertices.size(), insertion_grain, [&](std::size_t from, std::size_t to) {
      std::vector<StarTerm> star;
      for (const Index v : vertices.subspan(from, to - from)) {
        gather_star(level_.number_of(v), level_.stars(), level_.references(), level_points_, star);
        basis_.keep_stiffness(v, expand(energy, star, points_[v], TangentFrame(points_[v])), points_[v]);
      }
    });
  };
  std::visit(
      [&](const auto& energy) {
        keep(std::span(hierarchy_.removed).subspan(begin, end - begin), energy);
        if (round + 1 == hierarchy_.rounds()) keep(hierarchy_.tetrahedron, energy);
      },
      energy_);
}

void Refinement::optimise(Progress& progress) {
  const auto total = static_cast<std::uint64_t>(global_steps()) + 1;
  progress.report(Stage::optimise, 0, total);
  if (level_.triangles().empty()) { // the input is a tetrahedron, or the work goes on from the finest level
    level_.build(hierarchy_, positions_, fine_regularisation, pool_);
    order_.build(level_.stars(), pool_);
  }
  // From here on the level is the whole mesh: its numbers are the hierarchy's.
  energy_ = target_;
  converged = relax(final_sweeps, final_gain, points_, progress);
  GlobalStep global(whole_level(), basis_, pool_);
  for (int i = 0; i < global_steps() && hierarchy_.rounds() > 0; ++i) {
    progress.report(Stage::optimise, static_cast<std::uint64_t>(i) + 1, total);
    progress.check();
    const StepOutcome step = global.take(effort_.iterations, points_);
    centre(points_);
    const bool settled = relax(final_sweeps, final_gain, points_, progress);
    // A step that a fold cut short gains little because of one place, which the relaxation has just mended.
    const bool enough = step.gain < effort_.enough && (step.length == 0 || step.length >= 1);
    converged = settled && enough;
    if (enough) break;
  }
  centre(points_);
  progress.report(Stage::optimise, total, total);
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// The mesh along a Hilbert curve: its parts are then close together in memory on every level, and the result does not
// depend on how the input is numbered.
mesh::TriangleMesh reordered(const mesh::TriangleMesh& mesh, std::span<const Index> order, mesh::ThreadPool& pool) {
  mesh::TriangleMesh out{{}, mesh::renumbered(mesh.triangles, order, pool)};
  out.positions.reserve(order.size());
  for (const Index v : order) out.positions.push_back(mesh.positions[v]);
  return out;
}

} // namespace

Embedding embed_by_energy(const mesh::TriangleMesh& mesh, const TriangleEnergy& energy, Quality quality,
                          std::uint32_t threads, Progress& progress, Checkpoints& checkpoints) {
  mesh::ThreadPool pool(threads);
  Embedding out;
  auto start = std::chrono::steady_clock::now();
  const std::vector<Index> order = mesh::hilbert_order(mesh::unit_positions(mesh), pool);
  const mesh::TriangleMesh ordered = reordered(mesh, order, pool);
  Hierarchy hierarchy = build_hierarchy(ordered, pool, progress);
  out.t1_ms = milliseconds_since(start);
  start = std::chrono::steady_clock::now();
  Refinement refinement(energy, std::move(hierarchy), mesh::unit_positions(ordered), effort_of(quality), pool);
  refinement.refine(progress, checkpoints);
  out.t2_ms = milliseconds_since(start);
  start = std::chrono::steady_clock::now();
  refinement.optimise(progress);
  out.t3_ms = milliseconds_since(start);
  out.relaxations = refinement.relaxations;
  out.converged = refinement.converged;
  const std::vector<Vec3d> points = std::move(refinement).points();
  out.points.resize(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) out.points[order[i]] = points[i];
  return out;
}

} // namespace orbis::sphere
