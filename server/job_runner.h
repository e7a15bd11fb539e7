// How a job is run: an interface, so that the scheduler does not know about processes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/options.h"
#include "core/progress.h"

namespace orbis::server {

struct InputFile {
  std::string name; // as the model names it
  std::filesystem::path path;
  std::uint64_t bytes = 0;
};

struct OutputFile {
  std::string name; // "result.glb", "report.json", "atlas.png", "preview.png", "map-….png", a dump of a stage, or
                    // checkpoint_name
  std::uint64_t bytes = 0;
  std::string sha256;
};

// The output that a job replaces from time to time, to go on from where it is interrupted.
inline constexpr std::string_view checkpoint_name = "checkpoint";

// What the operator allows one job.
struct JobLimits {
  Limits content;
  std::uint64_t memory_bytes = 4ull << 30; // address space
  std::uint64_t output_bytes = 4ull << 30; // of all files together
  std::uint32_t seconds = 600;             // wall clock; CPU time: as much on every core
  int niceness = 10;                       // so that the server answers whatever the load
  std::uint32_t checkpoint_seconds = 10;   // from one checkpoint to the next, at least
};

struct JobTask {
  InputFile model;
  std::vector<InputFile> files;
  std::optional<InputFile> checkpoint; // that an interrupted run of the job has left
  Options options;
  JobLimits limits;
  bool dump_stages = false;
};

struct JobOutcome {
  std::optional<Error> error; // nothing: the job has succeeded
  std::vector<OutputFile> files;
  double wall_ms = 0, cpu_ms = 0;
  std::uint64_t peak_rss_bytes = 0;
};

// Called from the thread that runs the job.
struct JobHooks {
  std::function<void(Stage stage, std::uint64_t done, std::uint64_t total)> progress;
  // Where an output file goes; an empty path: it is not wanted. A checkpoint comes again and again.
  std::function<std::filesystem::path(std::string_view name)> place;
};

class JobRunner {
public:
  virtual ~JobRunner() = default;
  // Runs one job to its end. A stop request ends it within a second, with the error `canceled`. Thread-safe.
  [[nodiscard]] virtual JobOutcome run(const JobTask& task, const JobHooks& hooks, std::stop_token stop) = 0;
};

} // namespace orbis::server
