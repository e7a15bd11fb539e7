// A job as the contract shows it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/problem.h"
#include "core/options.h"
#include "core/progress.h"

namespace orbis::api {

using Time = std::chrono::sys_time<std::chrono::milliseconds>;

[[nodiscard]] inline Time now() {
  return std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

enum class JobState { queued, running, succeeded, failed, canceled, expired };
inline constexpr std::array<std::string_view, 6> job_state_names{"queued", "running",  "succeeded",
                                                                 "failed", "canceled", "expired"};
[[nodiscard]] constexpr std::string_view name_of(JobState state) {
  return job_state_names[static_cast<std::size_t>(state)];
}
[[nodiscard]] std::optional<JobState> job_state(std::string_view name);
// No further change but expiry.
[[nodiscard]] constexpr bool is_final(JobState state) {
  return state != JobState::queued && state != JobState::running;
}

// Time to go, in milliseconds: half and nine tenths of earlier jobs took no longer from the same percentage on.
struct TimeToGo {
  double p50 = 0, p90 = 0;
};

struct JobProgress {
  Stage stage = Stage::decode;
  std::uint64_t done = 0, total = 0;
  double percent = 0; // of the whole job, 0 to 100; never falls
  std::optional<TimeToGo> eta_ms;
};

struct StageTiming {
  std::string name;
  double wall_ms = 0, cpu_ms = 0;
};

struct Timing {
  std::optional<double> queue_ms, wall_ms, cpu_ms;
  std::optional<std::uint64_t> peak_rss_bytes;
  std::vector<StageTiming> stages;
};

struct JobInput {
  std::string sha256; // of the model; other files do not count
  std::uint64_t bytes = 0;
  std::optional<std::uint64_t> triangles; // known once the job has succeeded
};

struct JobResult {
  std::string sha256;
  std::uint64_t bytes = 0;
};

struct Job {
  std::string id; // ULID: sorts by time of creation
  JobState state = JobState::queued;
  Time created{};
  std::optional<Time> started, finished, expires;
  std::optional<std::uint64_t> queue_position; // 1 is next; only while queued
  std::uint32_t attempt = 0;                   // how often it was started
  bool cached = false;
  bool partial = false; // a component of the model could not be parametrized; the report says which and why
  std::optional<JobProgress> progress;
  Timing timing;
  Options options;
  JobInput input;
  std::optional<JobResult> result;
  std::vector<std::string> maps; // file names of the maps that were baked: "normal.png"
  std::optional<Problem> problem;
  std::uint64_t version = 0; // grows with every change; orders events
};

// How far the whole job is, in percent: each stage has a share of the time of a typical job.
[[nodiscard]] double overall_percent(Stage stage, std::uint64_t done, std::uint64_t total);

} // namespace orbis::api
