#include "server/time_to_go.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orbis::server {
namespace {

double quantile(std::vector<double> values, double q) {
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(q * static_cast<double>(values.size() - 1)));
  std::ranges::nth_element(values, values.begin() + rank);
  return values[static_cast<std::size_t>(rank)];
}

} // namespace

void Milestones::reach(double percent, double elapsed_ms) {
  for (std::size_t i = 0; i < count && percent >= 10.0 * static_cast<double>(i + 1); ++i) {
    if (times_.at(i) == 0) times_.at(i) = std::max(elapsed_ms, 1e-3);
  }
}

void TimeToGoModel::learn(const Milestones& milestones, double wall_ms) {
  for (std::size_t i = 0; i < Milestones::count; ++i) {
    if (milestones.at(i) == 0) continue;
    std::deque<double>& multiples = multiples_.at(i);
    multiples.push_back(std::max(0.0, wall_ms - milestones.at(i)) / milestones.at(i));
    if (multiples.size() > most_jobs) multiples.pop_front();
  }
}

std::optional<api::TimeToGo> TimeToGoModel::estimate(const Milestones& milestones, double elapsed_ms) const {
  for (std::size_t i = Milestones::count; i-- > 0;) {
    if (milestones.at(i) == 0) continue;
    const std::deque<double>& multiples = multiples_.at(i);
    if (multiples.size() < fewest_jobs) return std::nullopt;
    const std::vector<double> values(multiples.begin(), multiples.end());
    const auto to_go = [&](double q) {
      return std::max(0.0, milestones.at(i) * (1 + quantile(values, q)) - elapsed_ms);
    };
    return api::TimeToGo{to_go(0.5), to_go(0.9)};
  }
  return std::nullopt;
}

} // namespace orbis::server
