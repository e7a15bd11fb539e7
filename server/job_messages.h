// What a job's parent and child process say to each other.
//
// To the child, on its standard input: one line of JSON (the task), then the bytes of the model, of each file
// and of the checkpoint, if there is one.
// To the parent, on its standard output: lines of JSON, each one of
//   {"progress":{"stage":"refine","done":1,"total":2}}
//   {"file":{"name":"result.glb","bytes":123}}             followed by that many bytes
//   {"error":{"code":"not-genus-zero","message":"…","where":"…"}}
//   {"log":"…"}                                            for the operator, not for the client
//   {"done":true}
// The child reads untrusted data, so the parent believes nothing that is not one of these.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "server/job_runner.h"

namespace orbis::server {

[[nodiscard]] std::string task_line(const JobTask& task);
// The inverse; the files' paths are empty. Throws Error{internal}.
[[nodiscard]] JobTask parse_task(std::string_view line);

[[nodiscard]] std::string progress_line(Stage stage, std::uint64_t done, std::uint64_t total);
[[nodiscard]] std::string file_line(std::string_view name, std::uint64_t bytes);
[[nodiscard]] std::string error_line(const Error& error);
[[nodiscard]] std::string log_line(std::string_view text);
[[nodiscard]] std::string done_line();

// Cuts the child's output into messages.
class MessageParser {
public:
  struct Handler {
    std::function<void(Stage, std::uint64_t done, std::uint64_t total)> progress;
    std::function<void(std::string_view name, std::uint64_t bytes)> file_begins;
    std::function<void(std::span<const std::byte>)> file_bytes;
    std::function<void()> file_ends;
    std::function<void(const Error&)> error;
    std::function<void(std::string_view)> log;
    std::function<void()> done;
  };
  explicit MessageParser(Handler handler) : handler_(std::move(handler)) {}

  // Takes the next bytes as they come. Throws Error{internal} for anything that is no message.
  void feed(std::span<const std::byte> bytes);

private:
  void take_line();

  Handler handler_;
  std::string line_;
  std::uint64_t file_left_ = 0;
};

} // namespace orbis::server
