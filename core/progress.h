// Progress and cancellation: one object, passed down from the caller to every loop that can take long.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/error.h"

namespace orbis {

// The stages of a job, in the order in which they run. simplify, refine and optimise are the paper's t1, t2, t3.
enum class Stage { decode, topology, simplify, refine, optimise, atlas, levels, bake, encode, certify };

inline constexpr std::array<std::string_view, 10> stage_names{"decode", "topology", "simplify", "refine", "optimise",
                                                              "atlas",  "levels",   "bake",     "encode", "certify"};
inline constexpr std::size_t stage_count = stage_names.size();

constexpr std::string_view name_of(Stage s) { return stage_names[static_cast<std::size_t>(s)]; }

// Implementations must be cheap: report() is called every few thousand vertices from inner loops, from one thread
// at a time; cancelled() also from others beside it. `done` never falls within a stage and ends at `total`; stages come
// in the order of the enum.
class Progress {
public:
  virtual ~Progress() = default;
  virtual void report(Stage stage, std::uint64_t done, std::uint64_t total) = 0;
  [[nodiscard]] virtual bool cancelled() const = 0;

  // Throws Error{canceled} if the caller asked to stop.
  void check() const {
    if (cancelled()) throw Error(ErrorCode::canceled, "the job was canceled");
  }
};

// For callers that want neither.
class NoProgress final : public Progress {
public:
  void report(Stage, std::uint64_t, std::uint64_t) override {}
  [[nodiscard]] bool cancelled() const override { return false; }
};

} // namespace orbis
