// How long each stage took, seen from the progress reports that pass by.
#pragma once

#include <array>
#include <chrono>
#include <vector>

#include "core/progress.h"
#include "core/report.h"

namespace orbis {

// Passes progress on and charges the time between two reports of different stages to the earlier one. CPU time is that
// of the process, all threads together.
class StageClock final : public Progress {
public:
  explicit StageClock(Progress& inner);
  void report(Stage stage, std::uint64_t done, std::uint64_t total) override;
  [[nodiscard]] bool cancelled() const override { return inner_.cancelled(); }

  // The stages that ran, in their order. Ends the last one.
  [[nodiscard]] std::vector<StageTime> times();

private:
  void charge();

  Progress& inner_;
  Stage stage_ = Stage::decode;
  std::array<StageTime, stage_count> times_{};
  std::array<bool, stage_count> ran_{};
  std::chrono::steady_clock::time_point wall_;
  double cpu_ms_ = 0;
};

} // namespace orbis
