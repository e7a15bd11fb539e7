// Runs each job in a child process, so that a crash or a runaway in a decoder fails that job only.
#pragma once

#include <string>
#include <vector>

#include "server/job_runner.h"

namespace orbis::server {

class WorkerProcess final : public JobRunner {
public:
  // The program and its arguments; it must speak server/job_messages.h. By default this very binary as a job's child.
  explicit WorkerProcess(std::vector<std::string> command = {"/proc/self/exe", "job-child"})
      : command_(std::move(command)) {}

  // A stop request asks the child with SIGTERM and kills it after 300 ms; so does the wall clock limit. How the child
  // ends becomes an error: a crash `internal`, its limits `out_of_time` and `out_of_memory`.
  [[nodiscard]] JobOutcome run(const JobTask& task, const JobHooks& hooks, std::stop_token stop) override;

private:
  std::vector<std::string> command_;
};

} // namespace orbis::server
