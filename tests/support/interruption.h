// Checkpoints at every opportunity, and an interruption after some of them.
#pragma once

#include <vector>

#include "core/checkpoints.h"
#include "core/error.h"

namespace orbis::test {

class Interruption final : public Checkpoints {
public:
  // from: what an earlier run kept. after: how many checkpoints are kept before the run is interrupted; -1: it is not.
  explicit Interruption(std::vector<std::byte> from, int after) : from_(std::move(from)), left_(after) {}

  [[nodiscard]] bool due() const override { return true; }
  void keep(std::span<const std::byte> state) override {
    last.assign(state.begin(), state.end());
    if (--left_ == 0) throw Error(ErrorCode::canceled, "interrupted");
  }
  [[nodiscard]] std::span<const std::byte> kept() const override { return from_; }

  std::vector<std::byte> last;

private:
  std::vector<std::byte> from_;
  int left_;
};

// Runs work(checkpoints), which is interrupted after every `after` checkpoints and taken up again. Returns how often it
// was interrupted.
template <class Work> int interrupted(int after, Work work) {
  std::vector<std::byte> kept;
  for (int times = 0;; ++times) {
    Interruption checkpoints(kept, after);
    try {
      work(checkpoints);
      return times;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::canceled) throw;
      kept = checkpoints.last;
    }
  }
}

} // namespace orbis::test
