// How long will it still take? Asked of the jobs that went before.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>

#include "api/job.h"

namespace orbis::server {

// When a running job passed each tenth of its way.
class Milestones {
public:
  static constexpr std::size_t count = 9; // at 10, 20, …, 90 percent
  void reach(double percent, double elapsed_ms);
  // Time at which tenth + 1 tenths were done; 0: not yet.
  [[nodiscard]] double at(std::size_t tenth) const { return times_.at(tenth); }

private:
  std::array<double, count> times_{};
};

// From a milestone on, jobs of any size take about the same multiple of the time that has passed until then. The
// multiples of recent jobs give the quantiles. Not thread-safe.
class TimeToGoModel {
public:
  void learn(const Milestones& milestones, double wall_ms);
  // Nothing before the first milestone, or with fewer than 5 jobs learnt.
  [[nodiscard]] std::optional<api::TimeToGo> estimate(const Milestones& milestones, double elapsed_ms) const;

private:
  static constexpr std::size_t most_jobs = 64, fewest_jobs = 5;
  // multiples_[i]: (whole time - time of milestone i) / time of milestone i, of each recent job.
  std::array<std::deque<double>, Milestones::count> multiples_;
};

} // namespace orbis::server
