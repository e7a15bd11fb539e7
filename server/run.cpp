#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "api/json.h"
#include "server/commands.h"
#include "server/job_files.h"
#include "server/log.h"
#include "server/neighbours.h"
#include "server/signals.h"
#include "server/worker_process.h"

namespace orbis::server {
namespace fs = std::filesystem;

namespace {

constexpr int refused = 2, failed = 1;

InputFile input_file(std::string name, const fs::path& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error || !fs::is_regular_file(path, error)) {
    throw Error(ErrorCode::missing_resource, "'" + path.string() + "' is not a file that can be read");
  }
  return {std::move(name), path, bytes};
}

// A file under its name; a directory's regular files under their paths within it, as a glTF's URIs give them.
void attach(const fs::path& path, std::vector<InputFile>& files) {
  if (!fs::is_directory(path)) {
    files.push_back(input_file(path.filename().string(), path));
    return;
  }
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (!entry.is_regular_file() || entry.is_symlink()) continue;
    files.push_back(input_file(entry.path().lexically_relative(path).generic_string(), entry.path()));
  }
}

void check_size(const JobTask& task) {
  std::uint64_t bytes = task.model.bytes;
  for (const InputFile& file : task.files) bytes += file.bytes;
  if (bytes <= task.limits.content.max_bytes) return;
  throw Error(ErrorCode::too_large, "the model and its attachments have " + std::to_string(bytes) +
                                        " bytes; the limit max_bytes is " +
                                        std::to_string(task.limits.content.max_bytes));
}

JobTask task_of(const RunArguments& arguments, const JobLimits& limits) {
  JobTask task;
  for (const auto& [name, value] : arguments.options) set_option(task.options, name, value);
  task.model = input_file("model", arguments.input);
  for (const fs::path& path : arguments.attachments) attach(path, task.files);
  if (arguments.attachments.empty()) {
    for (const auto& [name, path] : named_neighbours(arguments.input)) task.files.push_back(input_file(name, path));
  }
  if (arguments.second) {
    attach(*arguments.second, task.files);
    task.options.morph_to = task.files.back().name;
  }
  task.limits = limits;
  task.limits.niceness = 0;
  task.dump_stages = arguments.dump_stages.has_value();
  check_size(task);
  return task;
}

// A line that is overwritten, on a terminal only.
class TerminalProgress {
public:
  void show(Stage stage, std::uint64_t done, std::uint64_t total) {
    if (!terminal_) return;
    percent_ = std::max(percent_, api::overall_percent(stage, done, total));
    std::fprintf(stderr, "\r%5.1f %%  %-10s", percent_, name_of(stage).data());
  }
  ~TerminalProgress() {
    if (terminal_ && percent_ > 0) std::fputs("\r\033[K", stderr);
  }

private:
  bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  double percent_ = 0;
};

fs::path place(const RunArguments& arguments, std::string_view name) {
  if (name == "result.glb") return arguments.output;
  if (name == "report.json") return arguments.report.value_or(fs::path());
  if (const auto map = map_of_output(name)) return arguments.save_maps ? *arguments.save_maps / *map : fs::path();
  if (name == "preview.png" && arguments.preview) return *arguments.preview;
  const bool picture = name == "atlas.png" || name == "preview.png"; // they are among the dumps, under their numbers
  return arguments.dump_stages && !picture ? *arguments.dump_stages / name : fs::path();
}

int print_problem(const Error& error) {
  const api::Problem problem = api::make_problem(error);
  std::cerr << api::dump(api::to_json(problem), 2) << '\n';
  return problem.status < 500 && error.code() != ErrorCode::canceled ? refused : failed;
}

} // namespace

int run(const RunArguments& arguments, const JobLimits& limits) {
  try {
    std::stop_source stop;
    const SignalWatch signals([&](int) { stop.request_stop(); });
    const JobTask task = task_of(arguments, limits);
    if (arguments.save_maps) fs::create_directories(*arguments.save_maps);
    if (arguments.dump_stages) fs::create_directories(*arguments.dump_stages);
    JobOutcome outcome;
    {
      TerminalProgress progress;
      const JobHooks hooks{
          [&](Stage stage, std::uint64_t done, std::uint64_t total) { progress.show(stage, done, total); },
          [&](std::string_view name) { return place(arguments, name); }};
      outcome = WorkerProcess().run(task, hooks, stop.get_token());
    }
    return outcome.error ? print_problem(*outcome.error) : 0;
  } catch (const Error& error) {
    return print_problem(error);
  } catch (const fs::filesystem_error& error) {
    return print_problem(Error(ErrorCode::internal, error.what()));
  }
}

} // namespace orbis::server
