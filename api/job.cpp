#include "api/job.h"

#include <algorithm>
#include <numeric>

namespace orbis::api {

std::optional<JobState> job_state(std::string_view name) {
  const auto* it = std::ranges::find(job_state_names, name);
  if (it == job_state_names.end()) return std::nullopt;
  return static_cast<JobState>(it - job_state_names.begin());
}

double overall_percent(Stage stage, std::uint64_t done, std::uint64_t total) {
  // Percent of the wall time of a scan of 100k triangles with default options: decode, topology, simplify, refine,
  // optimise, atlas, levels (none by default), bake, encode, certify.
  constexpr std::array<double, stage_count> shares{3, 3, 5, 39, 20, 5, 0, 10, 10, 5};
  static_assert(std::accumulate(shares.begin(), shares.end(), 0.0) == 100.0);
  const auto index = static_cast<std::ptrdiff_t>(stage);
  const double before = std::accumulate(shares.begin(), shares.begin() + index, 0.0);
  const double within = total == 0 ? 0.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  return before + shares[static_cast<std::size_t>(index)] * within;
}

} // namespace orbis::api
