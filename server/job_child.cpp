#include "server/job_child.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <new>
#include <optional>
#include <system_error>

#include "api/json.h"
#include "core/pipeline.h"
#include "server/job_files.h"
#include "server/job_messages.h"
#include "server/sandbox.h"

namespace orbis::server {
namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free); // it is set by a signal handler

void send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) ::_exit(1); // the parent is gone
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void send(std::string_view text) { send(std::as_bytes(std::span(text))); }

void send_file(std::string_view name, std::span<const std::byte> contents) {
  send(file_line(name, contents.size()));
  send(contents);
}

// At most 20 messages a second, but always the first and the last of a stage.
class PipeProgress final : public Progress {
public:
  void report(Stage stage, std::uint64_t done, std::uint64_t total) override {
    const auto time = std::chrono::steady_clock::now();
    if (stage == stage_ && done < total && time < next_) return;
    stage_ = stage;
    next_ = time + std::chrono::milliseconds(50);
    send(progress_line(stage, done, total));
  }
  [[nodiscard]] bool cancelled() const override { return stop_requested.load(std::memory_order_relaxed); }

private:
  std::optional<Stage> stage_;
  std::chrono::steady_clock::time_point next_;
};

class PipeCheckpoints final : public Checkpoints {
public:
  PipeCheckpoints(std::vector<std::byte> kept, std::chrono::seconds interval)
      : kept_(std::move(kept)), interval_(interval) {}
  [[nodiscard]] bool due() const override { return std::chrono::steady_clock::now() - last_ >= interval_; }
  void keep(std::span<const std::byte> state) override {
    send_file(checkpoint_name, state);
    last_ = std::chrono::steady_clock::now();
  }
  [[nodiscard]] std::span<const std::byte> kept() const override { return kept_; }

private:
  std::vector<std::byte> kept_;
  std::chrono::seconds interval_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void receive(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const auto got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw Error(ErrorCode::internal, "the job's input ended early");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

// Byte by byte: what follows the line belongs to the files.
std::string receive_line() {
  std::string line;
  for (char c = 0; c != '\n'; line += c) receive(std::as_writable_bytes(std::span(&c, 1)));
  return line;
}

std::vector<std::byte> receive_file(const InputFile& file) {
  std::vector<std::byte> contents(file.bytes);
  receive(contents);
  return contents;
}

void run_task() {
  const JobTask task = parse_task(receive_line());
  apply_resource_limits(task.limits);
  const std::vector<std::byte> model = receive_file(task.model);
  Request request{model, {}, task.options};
  for (const InputFile& file : task.files) request.files.insert_or_assign(file.name, receive_file(file));
  PipeCheckpoints checkpoints(task.checkpoint ? receive_file(*task.checkpoint) : std::vector<std::byte>(),
                              std::chrono::seconds(task.limits.checkpoint_seconds));
  enter_sandbox();

  PipeProgress progress;
  const StageDump dump = task.dump_stages ? StageDump(send_file) : StageDump();
  const Result result = process(request, task.limits.content, progress, checkpoints, dump);
  const std::string report = api::dump(api::to_json(result.report), 2) + "\n";
  send_file("result.glb", result.glb);
  send_file("atlas.png", result.atlas_png);
  send_file("preview.png", result.preview_png);
  for (const MapFile& map : result.maps) send_file(output_of_map(map.name), map.bytes);
  send_file("report.json", std::as_bytes(std::span(report)));
  send(done_line());
}

Error out_of_memory() {
  return {ErrorCode::out_of_memory, "the model needs more memory than a job may use here; reduce it, or its textures"};
}

} // namespace

void run_job_child() {
  detach_from_parent();
  std::signal(SIGXFSZ, SIG_IGN); // a library that prints to a log file must not die of the limit on file sizes
  std::signal(SIGTERM, [](int) { stop_requested.store(true, std::memory_order_relaxed); });
  try {
    run_task();
  } catch (const Error& error) {
    send(error_line(error));
  } catch (const std::bad_alloc&) {
    send(error_line(out_of_memory()));
  } catch (const std::system_error& error) {
    // A thread that could not be started for want of memory.
    const bool memory = error.code() == std::errc::resource_unavailable_try_again;
    send(error_line(memory ? out_of_memory() : Error(ErrorCode::internal, "the job failed unexpectedly")));
  } catch (const std::exception& error) {
    send(log_line(error.what()));
    send(error_line(Error(ErrorCode::internal, "the job failed unexpectedly")));
  }
  ::_exit(0); // nothing to tidy: no destructor of a library may spoil a finished job
}

} // namespace orbis::server
