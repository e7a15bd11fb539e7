// A job runner that does what a test tells it to.
#pragma once

#include <condition_variable>
#include <mutex>
#include <random>

#include "server/file_writer.h"
#include "server/job_runner.h"

namespace orbis::test {

class FakeRunner final : public server::JobRunner {
public:
  enum class Behaviour { succeed, fail, crash, hang, keep_and_hang, no_report };
  Behaviour behaviour = Behaviour::succeed;

  server::JobOutcome run(const server::JobTask& task, const server::JobHooks& hooks, std::stop_token stop) override {
    {
      const std::scoped_lock lock(mutex_);
      ++started_;
      last_task = task;
    }
    changed_.notify_all();
    server::JobOutcome outcome;
    outcome.wall_ms = 10;
    outcome.cpu_ms = 20;
    outcome.peak_rss_bytes = 1000;
    hooks.progress(Stage::decode, 1, 1);
    hooks.progress(Stage::refine, 1, 2);
    switch (behaviour) {
    case Behaviour::succeed:
      write_outputs(hooks, outcome, true);
      break;
    case Behaviour::no_report:
      write_outputs(hooks, outcome, false);
      break;
    case Behaviour::fail:
      outcome.error = Error(ErrorCode::not_genus_zero, "a torus");
      break;
    case Behaviour::crash:
      outcome.error = Error(ErrorCode::internal, "the job's process ended unexpectedly");
      break;
    case Behaviour::keep_and_hang:
      write(hooks, std::string(server::checkpoint_name), "half way", outcome);
      outcome.error = hang(stop);
      break;
    case Behaviour::hang:
      outcome.error = hang(stop);
      break;
    }
    return outcome;
  }

  // Blocks until `count` jobs have been started in all.
  void wait_started(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return started_ >= count; });
  }
  // Lets those that hang succeed in nothing: they fail.
  void release() {
    const std::scoped_lock lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }

  server::JobTask last_task;

private:
  static void write_outputs(const server::JobHooks& hooks, server::JobOutcome& outcome, bool with_report) {
    const std::string report =
        R"({"timing":{"stages":[{"name":"refine","wall_ms":5,"cpu_ms":6}]},"partial":false,"input":{"triangles":12}})";
    for (const std::string name : {"result.glb", "atlas.png", "preview.png", "map-normal.png", "report.json"}) {
      if (name == "report.json" && !with_report) continue;
      write(hooks, name, name == "report.json" ? report : "contents of " + name, outcome);
    }
  }

  static void write(const server::JobHooks& hooks, const std::string& name, const std::string& contents,
                    server::JobOutcome& outcome) {
    server::FileWriter writer(hooks.place(name));
    writer.write(std::as_bytes(std::span(contents)));
    outcome.files.push_back({name, contents.size(), writer.commit()});
  }

  Error hang(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [&] { return released_; });
    return stop.stop_requested() ? Error(ErrorCode::canceled, "the job was canceled")
                                 : Error(ErrorCode::invalid_geometry, "released");
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  int started_ = 0;
  bool released_ = false;
};

} // namespace orbis::test
