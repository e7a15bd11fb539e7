#include "core/steps/stage_clock.h"

#include <ctime>

namespace orbis {
namespace {

double process_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

} // namespace

StageClock::StageClock(Progress& inner)
    : inner_(inner), wall_(std::chrono::steady_clock::now()), cpu_ms_(process_cpu_ms()) {
  for (std::size_t i = 0; i < stage_count; ++i) times_[i].stage = static_cast<Stage>(i);
}

void StageClock::charge() {
  const auto now = std::chrono::steady_clock::now();
  const double cpu = process_cpu_ms();
  StageTime& time = times_[static_cast<std::size_t>(stage_)];
  time.wall_ms += std::chrono::duration<double, std::milli>(now - wall_).count();
  time.cpu_ms += cpu - cpu_ms_;
  ran_[static_cast<std::size_t>(stage_)] = true;
  wall_ = now;
  cpu_ms_ = cpu;
}

void StageClock::report(Stage stage, std::uint64_t done, std::uint64_t total) {
  if (stage != stage_) {
    charge();
    stage_ = stage;
  }
  inner_.report(stage, done, total);
}

std::vector<StageTime> StageClock::times() {
  charge();
  std::vector<StageTime> out;
  for (std::size_t i = 0; i < stage_count; ++i) {
    if (ran_[i]) out.push_back(times_[i]);
  }
  return out;
}

} // namespace orbis
