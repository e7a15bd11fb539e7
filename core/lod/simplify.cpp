#include "core/lod/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <limits>
#include <optional>

#include "core/lod/bucket_queue.h"
#include "core/lod/collapse.h"
#include "core/lod/drop_components.h"
#include "core/lod/extract.h"
#include "core/lod/refine.h"

namespace orbis::lod {
namespace {

constexpr double speck = 0.01; // of the diagonal: a component below that goes before a seam is torn
constexpr double any_size = std::numeric_limits<double>::infinity();
constexpr std::uint32_t report_interval = 1U << 12U;
constexpr std::size_t grain = 1024; // points

// The next edge to collapse, valid as long as neither end has changed.
struct Candidate {
  float cost;
  std::uint32_t a, b;
  std::uint32_t versions; // of both ends, added
  std::uint16_t attempt;
  Seams seams;
};

class Simplifier {
public:
  Simplifier(const FullSurface& full, mesh::ThreadPool& threads, Progress& progress)
      : full_(full), progress_(progress), threads_(threads), mesh_(full, threads), collapser_(full, mesh_) {
    first_count_ = mesh_.triangle_count;
    fill_queue();
  }

  Level next(const Target& target) {
    if (has_set_aside_) fill_queue();
    has_set_aside_ = false;
    while (!is_met(target)) {
      if (step(target)) continue;
      if (stopped_by_bound_) break;
      // The queue ran dry. What was refused may be possible by now; if nothing was, something has to give way.
      if (collapsed_since_filled_ == 0 && !(target.triangles > 0 && concede(target.triangles))) break;
      fill_queue();
    }
    const bool has_too_many = target.triangles > 0 && mesh_.triangle_count > target.triangles && !stopped_by_bound_;
    // Levels only get coarser: after one that is coarser than the bound, there is none within it.
    concessions_.is_short = has_too_many || (target.deviation > 0 && std::sqrt(largest_) > target.deviation);
    for (const Point& p : mesh_.points)
      if (p.is_alive) concessions_.outline = std::max(concessions_.outline, double{p.drift});
    Level level = extract(full_, mesh_);
    level.concessions = concessions_;
    level.deviation = std::sqrt(largest_);
    return level;
  }

private:
  [[nodiscard]] bool is_met(const Target& target) const { return mesh_.triangle_count <= target.triangles; }

  void fill_queue() {
    collapsed_since_filled_ = 0;
    std::vector<std::vector<Candidate>> found((mesh_.points.size() + grain - 1) / grain);
    threads_.for_blocks(mesh_.points.size(), grain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> ring;
      for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p) {
        if (!mesh_.points[p].is_alive) continue;
        mesh_.neighbours_of(p, ring);
        for (const std::uint32_t q : ring) {
          if (p < q)
            for_candidates(p, q, [&](const Candidate& candidate) { found[begin / grain].push_back(candidate); });
        }
      }
    });
    queue_.clear();
    for (const std::vector<Candidate>& block : found)
      for (const Candidate& candidate : block) queue_.push(candidate);
  }

  // The first attempt from `attempt` on that is possible.
  [[nodiscard]] std::optional<Candidate> candidate_of(std::uint32_t a, std::uint32_t b, Seams seams,
                                                      std::uint16_t attempt) const {
    if (a > b) std::swap(a, b);
    for (; attempt < Collapser::attempts; ++attempt)
      if (const std::optional<Collapse> collapse = collapser_.propose(a, b, seams, attempt))
        return Candidate{static_cast<float>(collapse->cost * collapse->price()), a, b, versions(a, b), attempt, seams};
    return std::nullopt;
  }

  // Keeping seams, and where there are any, breaking them.
  template <class Visit> void for_candidates(std::uint32_t a, std::uint32_t b, Visit visit) const {
    for (const Seams seams : {Seams::kept, Seams::broken}) {
      if (seams == Seams::broken && !collapser_.meets_seam(a, b)) continue;
      if (const std::optional<Candidate> candidate = candidate_of(a, b, seams, 0)) visit(*candidate);
    }
  }

  [[nodiscard]] std::uint32_t versions(std::uint32_t a, std::uint32_t b) const {
    return mesh_.points[a].version + mesh_.points[b].version;
  }

  // Takes the next candidate; false where there is none or the bound forbids it.
  bool step(const Target& target) {
    if (queue_.is_empty()) return false;
    const Candidate next = queue_.top();
    const bool is_alive = mesh_.points[next.a].is_alive && mesh_.points[next.b].is_alive;
    const bool is_valid = is_alive && next.versions == versions(next.a, next.b);
    const std::optional<Collapse> collapse =
        is_valid ? collapser_.propose(next.a, next.b, next.seams, next.attempt) : std::nullopt;
    if (!collapse) {
      queue_.pop();
      return true;
    }
    if (target.deviation > 0 && next.seams == Seams::broken) { // a bound says nothing of the step between the texels
      queue_.pop();
      has_set_aside_ = true;
      return true;
    }
    const double deviation = squared_deviation(*collapse);
    stopped_by_bound_ = target.deviation > 0 && deviation > target.deviation * target.deviation;
    if (stopped_by_bound_) return false;
    queue_.pop();
    const std::span<const std::uint32_t> kept = collapser_.perform(*collapse);
    if (kept.empty()) {
      const auto after = static_cast<std::uint16_t>(next.attempt + 1);
      if (const std::optional<Candidate> other = candidate_of(next.a, next.b, next.seams, after)) queue_.push(*other);
      return true;
    }
    largest_ = std::max(largest_, deviation);
    ++collapsed_since_filled_;
    if (collapse->tears()) ++concessions_.torn;
    if (mesh_.points[collapse->removed].is_joint && !collapser_.constraints.keeps_joints) ++concessions_.opened;
    for (const std::uint32_t p : kept) {
      mesh_.neighbours_of(p, ring_);
      for (const std::uint32_t q : ring_)
        for_candidates(p, q, [&](const Candidate& candidate) { queue_.push(candidate); });
    }
    report();
    return true;
  }

  // Q over its weights: the mean square deviation that the collapse would leave.
  [[nodiscard]] double squared_deviation(const Collapse& collapse) const {
    double weight = 0;
    const auto& [at_removed, at_kept, triangles] = collapse.sides;
    for (const auto& at : {at_removed, at_kept})
      weight += mesh_.quadrics[at[0]].weight + (at[1] != at[0] ? mesh_.quadrics[at[1]].weight : 0);
    return weight > 0 ? collapse.cost / weight : 0;
  }

  // The next thing gives way; false where nothing is left.
  bool concede(std::uint64_t triangles) {
    Constraints& c = collapser_.constraints;
    if (c.keeps_normals) {
      c.keeps_normals = false;
      concessions_.turned_normals = true;
      return true;
    }
    if (drop(triangles, speck)) return true;
    if (!c.keeps_joints) return drop(triangles, any_size);
    c.keeps_joints = false;
    return true;
  }

  bool drop(std::uint64_t triangles, double below) {
    const Dropped dropped = drop_components(mesh_, triangles, below);
    concessions_.lost_components += dropped.components;
    concessions_.lost_triangles += dropped.triangles;
    concessions_.largest_lost = std::max(concessions_.largest_lost, dropped.largest);
    return dropped.components > 0;
  }

  void report() {
    if (++collapses_ % report_interval != 0) return;
    progress_.check();
    progress_.report(Stage::levels, first_count_ - mesh_.triangle_count, first_count_);
  }

  const FullSurface& full_;
  Progress& progress_;
  mesh::ThreadPool& threads_;
  WedgeMesh mesh_;
  Collapser collapser_;
  Concessions concessions_;
  BucketQueue<Candidate> queue_;
  std::vector<std::uint32_t> ring_;
  std::uint64_t first_count_ = 0, collapses_ = 0, collapsed_since_filled_ = 0;
  double largest_ = 0;
  bool stopped_by_bound_ = false;
  bool has_set_aside_ = false; // candidates that another target may take
};

} // namespace

std::vector<Level> simplify(const FullSurface& full, std::span<const Target> targets, mesh::ThreadPool& threads,
                            Progress& progress) {
  Simplifier simplifier(full, threads, progress);
  std::vector<Level> levels(targets.size());
  std::vector<std::future<void>> touches; // after the levels: they end before those do
  for (std::size_t i = 0; i < targets.size(); ++i) {
    levels[i] = simplifier.next(targets[i]);
    touches.push_back(
        std::async(threads.beside(), [&full, &progress, &level = levels[i]] { refine(full, level, progress); }));
  }
  for (std::future<void>& touch : touches) touch.get();
  return levels;
}

} // namespace orbis::lod
