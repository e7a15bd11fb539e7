#include "core/sphere/shape_preserving_relaxation.h"

#include <algorithm>
#include <cmath>

#include "core/sphere/floater_weights.h"
#include "core/sphere/shape_preserving_placement.h"

namespace orbis::sphere {

using mesh::Index;

void EqualWeights::gather(Index v, std::vector<Index>& ring, Star& star) const {
  one_ring(mesh_, v, ring);
  star.weight.assign(ring.size(), 1 / static_cast<double>(ring.size()));
}

FloaterWeights::FloaterWeights(const HalfEdgeMesh& mesh, const std::vector<Vec3d>& positions, Progress& progress)
    : begin_{0} {
  constexpr Index check_every = 1024;
  std::vector<Index> ring;
  std::vector<Vec3d> around;
  ring_.reserve(mesh.n_vertices() * 6);
  weight_.reserve(mesh.n_vertices() * 6);
  for (Index v = 0; v < positions.size(); ++v) {
    if (v % check_every == 0) progress.check();
    one_ring(mesh, v, ring);
    around.clear();
    for (const Index u : ring) around.push_back(positions[u]);
    const std::vector<double> weight = floater_weights(positions[v], around);
    ring_.insert(ring_.end(), ring.begin(), ring.end());
    weight_.insert(weight_.end(), weight.begin(), weight.end());
    begin_.push_back(ring_.size());
  }
}

void FloaterWeights::gather(Index v, std::vector<Index>& ring, Star& star) const {
  ring.assign(&ring_[begin_[v]], ring_.data() + begin_[v + 1]);
  star.weight.assign(&weight_[begin_[v]], weight_.data() + begin_[v + 1]);
}

void ImprovementQueue::put(std::size_t at, Entry entry) {
  heap_[at] = entry;
  place_[entry.vertex] = static_cast<std::uint32_t>(at);
}

void ImprovementQueue::sift(std::size_t at, Entry entry) {
  while (at > 0 && entry < heap_[(at - 1) / 2]) {
    put(at, heap_[(at - 1) / 2]);
    at = (at - 1) / 2;
  }
  for (std::size_t child = 2 * at + 1; child < heap_.size(); child = 2 * at + 1) {
    if (child + 1 < heap_.size() && heap_[child + 1] < heap_[child]) ++child;
    if (!(heap_[child] < entry)) break;
    put(at, heap_[child]);
    at = child;
  }
  put(at, entry);
}

void ImprovementQueue::set(Index v, double ratio) {
  if (place_[v] == absent) {
    place_[v] = static_cast<std::uint32_t>(heap_.size());
    heap_.push_back({ratio, v});
  }
  sift(place_[v], {ratio, v});
}

void ImprovementQueue::erase(Index v) {
  const std::uint32_t at = place_[v];
  if (at == absent) return;
  place_[v] = absent;
  const Entry last = heap_.back();
  heap_.pop_back();
  if (last.vertex != v) sift(at, last);
}

Relaxation::Relaxation(const StarSource& source, std::vector<Vec3d>& points, double threshold, Progress& progress)
    : source_(source), points_(points), threshold_(threshold), fine_threshold_(1 - 0.1 * (1 - threshold)),
      gain_(std::min(1e-4, 0.1 * (1 - fine_threshold_))), progress_(progress), queue_(points.size()),
      place_(points.size()), stale_(points.size(), 0), valence_(points.size(), 0) {}

const Star& Relaxation::star(Index v) {
  source_.gather(v, ring_, star_);
  star_.centre = points_[v];
  star_.ring.clear();
  for (const Index u : ring_) star_.ring.push_back(points_[u]);
  visits_ += ring_.size();
  return star_;
}

void Relaxation::touch(Index v) {
  const Place best = best_place(star(v), floor_, gain_);
  stale_[v] = 0;
  valence_[v] = static_cast<std::uint32_t>(ring_.size());
  place_[v] = best.point;
  if (best.ratio < (best.pressed ? fine_threshold_ : threshold_))
    queue_.set(v, best.ratio);
  else
    queue_.erase(v);
}

// A neighbour of v moved. A hub has so many neighbours that one hardly matters: it is evaluated once for every few
// moves, so that a move costs the same whatever the valences.
void Relaxation::touch_neighbour(Index v) {
  constexpr std::uint32_t usual_valence = 12;
  if (++stale_[v] * usual_valence >= valence_[v]) touch(v);
}

void Relaxation::touch_ring(Index v) {
  source_.gather(v, moved_ring_, star_);
  for (const Index u : moved_ring_) touch_neighbour(u);
}

void Relaxation::touch_all(std::span<const Index> vertices) {
  for (const Index v : vertices) {
    check_now_and_then();
    touch(v);
  }
}

void Relaxation::check_now_and_then() {
  constexpr std::uint64_t every = 20'000; // visits of neighbours: some milliseconds
  if (visits_ < next_check_) return;
  progress_.check();
  next_check_ = visits_ + every;
}

bool Relaxation::unfolded(std::span<const Index> vertices) {
  return std::all_of(vertices.begin(), vertices.end(), [&](Index v) {
    check_now_and_then();
    const Star& s = star(v);
    return std::isfinite(star_energy(s, s.centre, floor_));
  });
}

bool Relaxation::balance(std::span<const Index> vertices) {
  constexpr double centred = 0.01;
  constexpr int rounds = 20;
  constexpr double smallest_part = 1 / 16.0; // of a map, below which it is not worth its while
  const double share = 1 / static_cast<double>(vertices.size());
  std::vector<Vec3d> before(vertices.size());
  bool moved = false;
  for (int round = 0; round < rounds; ++round) {
    Vec3d mean;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      before[i] = points_[vertices[i]];
      mean += before[i] * share;
    }
    if (norm(mean) < centred) break;
    // An even spread answers the map of a with a shift of its mean by 4/3 a: 3/4 of the mean is Newton's step.
    double part = 0.75;
    for (bool good = false; !good; part *= 0.5) {
      const bool give_up = part < 0.75 * smallest_part;
      for (std::size_t i = 0; i < vertices.size(); ++i)
        points_[vertices[i]] = give_up ? before[i] : moebius(before[i], mean * part);
      if (give_up) return moved;
      good = unfolded(vertices);
    }
    moved = true;
  }
  return moved;
}

bool Relaxation::run(std::uint64_t budget) {
  for (const std::uint64_t end = visits_ + budget; !queue_.empty();) {
    if (visits_ >= end) return false;
    check_now_and_then();
    const Index v = queue_.top();
    if (stale_[v] > 0) {
      touch(v); // a hub whose place is out of date
      continue;
    }
    points_[v] = place_[v];
    queue_.erase(v);
    ++moves_;
    touch(v);
    touch_ring(v);
  }
  return true;
}

} // namespace orbis::sphere
