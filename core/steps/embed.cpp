#include "core/steps/embed.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <numeric>

#include "core/mesh/thread_pool.h"
#include "core/sphere/canonical_turn.h"
#include "core/sphere/embedding.h"
#include "core/steps/component_checkpoints.h"
#include "core/steps/leave_out.h"

namespace orbis {
namespace {

// A component of fewer triangles is the work of one thread: starting others would take longer.
constexpr std::uint32_t small_component = 20'000;

// The stages of one component are not those of the job. All components together are the job's refine stage; what is
// reported is how many vertices are done. May be called from several threads.
class SharedProgress {
public:
  SharedProgress(Progress& inner, std::uint64_t total) : inner_(inner), total_(total) {
    inner_.report(Stage::simplify, 0, 1);
    inner_.report(Stage::simplify, 1, 1);
    inner_.report(Stage::refine, 0, total_);
  }
  void finish() {
    inner_.report(Stage::refine, total_, total_);
    inner_.report(Stage::optimise, 1, 1);
  }
  void add(std::uint64_t vertices) {
    const std::lock_guard lock(mutex_);
    done_ += vertices;
    // Thousands of tiny components need not be told one by one.
    if (done_ - told_ < total_ / 100) return;
    told_ = done_;
    inner_.report(Stage::refine, done_, total_);
  }
  [[nodiscard]] bool cancelled() {
    const std::lock_guard lock(mutex_);
    return inner_.cancelled();
  }

private:
  Progress& inner_;
  std::mutex mutex_;
  std::uint64_t done_ = 0, told_ = 0, total_;
};

// What a component sees of it.
class OnlyCancellation final : public Progress {
public:
  explicit OnlyCancellation(SharedProgress& shared) : shared_(shared) {}
  void report(Stage, std::uint64_t, std::uint64_t) override {}
  [[nodiscard]] bool cancelled() const override { return shared_.cancelled(); }

private:
  SharedProgress& shared_;
};

class Embedder {
public:
  Embedder(const Surface& surface, const Options& options, Checkpoints& checkpoints)
      : surface_(surface), options_(options), state_(surface), checkpoints_(checkpoints, surface, state_) {}

  void run_one(Progress& progress) { embed_large(0, surface_.mesh, progress); }

  void run_all(Progress& progress) {
    SharedProgress shared(progress, surface_.mesh.positions.size());
    OnlyCancellation quiet(shared);
    std::vector<std::uint32_t> small;
    for (std::uint32_t c = 0; c < surface_.components.size(); ++c) {
      if (surface_.components[c].triangles < small_component) {
        small.push_back(c);
      } else {
        embed_large(c, mesh_of(surface_, surface_.components[c]), quiet);
        shared.add(surface_.components[c].vertices);
      }
    }
    run_small(small, shared, quiet);
    checkpoints_.keep_if_due();
    shared.finish();
  }

  void fill(Report& report) const {
    for (std::size_t c = 0; c < state_.embeddings.size(); ++c) {
      report.t1_ms += state_.embeddings[c].t1_ms;
      report.t2_ms += state_.embeddings[c].t2_ms;
      report.t3_ms += state_.embeddings[c].t3_ms;
      report.relaxations += state_.embeddings[c].relaxations;
      report.converged = report.converged && state_.embeddings[c].converged;
      report.minimum += state_.minimum[c];
    }
  }

  std::vector<Vec3d> take_points() { return std::move(state_.points); }
  [[nodiscard]] const Problems& problems() const { return problems_; }

private:
  // With all threads, and with checkpoints.
  void embed_large(std::uint32_t c, const mesh::TriangleMesh& mesh, Progress& progress) {
    if (state_.done[c] != 0) return;
    ComponentCheckpoints::OfOne checkpoints(checkpoints_, c);
    try_to_embed(c, mesh, options_.threads, progress, checkpoints);
    checkpoints_.keep_if_due();
  }

  // The largest first, so that no thread is left with a large one at the end.
  void run_small(std::vector<std::uint32_t>& small, SharedProgress& shared, Progress& quiet) {
    std::ranges::stable_sort(small, std::greater<>(),
                             [&](std::uint32_t c) { return surface_.components[c].triangles; });
    std::mutex mutex;
    std::exception_ptr failure;
    mesh::ThreadPool pool(small.size() < 2 ? 1 : options_.threads);
    pool.for_blocks(small.size(), 1, [&](std::size_t begin, std::size_t) {
      const std::uint32_t c = small[begin];
      NoCheckpoints none;
      try {
        quiet.check();
        if (state_.done[c] == 0) try_to_embed(c, mesh_of(surface_, surface_.components[c]), 1, quiet, none);
        shared.add(surface_.components[c].vertices);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    });
    if (failure) std::rethrow_exception(failure);
  }

  void try_to_embed(std::uint32_t c, const mesh::TriangleMesh& mesh, std::uint32_t threads, Progress& progress,
                    Checkpoints& checkpoints) {
    try {
      embed(c, mesh, threads, progress, checkpoints);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::not_certified) throw;
      const std::lock_guard lock(problems_mutex_);
      problems_[c] = {"not-embedded", e.message(), "/meshes/" + std::to_string(surface_.components[c].mesh)};
    }
  }

  void embed(std::uint32_t c, const mesh::TriangleMesh& mesh, std::uint32_t threads, Progress& progress,
             Checkpoints& checkpoints) {
    sphere::Embedding& out = state_.embeddings[c];
    out = sphere::embed(mesh, options_, threads, progress, checkpoints);
    state_.minimum[c] = sphere::shape_preserving_energy(mesh, out.points);
    const std::vector<Vec3d> turned = sphere::canonically_turned(mesh, std::move(out.points));
    std::ranges::copy(turned, state_.points.begin() + surface_.components[c].first_vertex);
    out.points = {};
    state_.done[c] = 1;
  }

  const Surface& surface_;
  const Options& options_;
  EmbeddedComponents state_;
  ComponentCheckpoints checkpoints_;
  Problems problems_;
  std::mutex problems_mutex_;
};

} // namespace

std::vector<Vec3d> embed(Surface& surface, const Options& options, Progress& progress, Checkpoints& checkpoints,
                         Report& report) {
  Embedder embedder(surface, options, checkpoints);
  if (surface.components.size() == 1) {
    embedder.run_one(progress);
  } else {
    embedder.run_all(progress);
  }
  embedder.fill(report);
  if (!report.converged) {
    report.notes.push_back({"not-converged",
                            "the bound on the work was reached while moves still paid: the map is valid, but could be "
                            "better",
                            ""});
  }
  std::vector<Vec3d> points = embedder.take_points();
  leave_out(embedder.problems(), surface, points, report);
  return points;
}

} // namespace orbis
