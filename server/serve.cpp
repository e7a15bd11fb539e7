#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <semaphore>
#include <vector>

#include "server/commands.h"
#include "server/file_descriptor.h"
#include "server/log.h"
#include "server/sha256.h"
#include "server/signals.h"
#include "server/worker_process.h"

namespace orbis::server {
namespace {

// One service at a time on a data directory.
FileDescriptor lock_data(const std::filesystem::path& data) {
  std::error_code error;
  std::filesystem::create_directories(data, error);
  FileDescriptor lock(::open((data / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!lock.is_open())
    throw Error(ErrorCode::invalid_option, "the data directory '" + data.string() + "' cannot be written", "data");
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    throw Error(ErrorCode::invalid_option,
                "another orbis serves the data directory '" + data.string() + "'; give this one a directory of its own",
                "data");
  }
  return lock;
}

// Each connection takes a descriptor or two: as many as the system gives.
void raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

// The program's own digest: a result is as good as another, and a checkpoint of use, only if the same build made it.
std::string build_digest() {
  Sha256 digest;
  std::ifstream self("/proc/self/exe", std::ios::binary);
  std::vector<char> piece(1 << 20);
  while (self.read(piece.data(), static_cast<std::streamsize>(piece.size())) || self.gcount() > 0) {
    digest.update(std::as_bytes(std::span(piece).first(static_cast<std::size_t>(self.gcount()))));
  }
  if (!self.eof())
    throw Error(ErrorCode::internal, "the program cannot read itself, which the cache of results and checkpoints need");
  return digest.finish();
}

} // namespace

int serve(const Config& config) {
  std::binary_semaphore stop_requested{0};
  const SignalWatch signals([&](int count) {
    if (count > 1) ::_exit(1); // what runs is taken up at the next start
    stop_requested.release();
  });
  raise_descriptor_limit();
  const FileDescriptor lock = lock_data(config.data);
  JobStore store(config.data / "jobs.sqlite");
  BlobStore blobs(config.data);
  Metrics metrics;
  WorkerProcess runner;
  SchedulerSettings settings = config.scheduler;
  settings.build = build_digest();
  Scheduler scheduler(store, blobs, runner, metrics, settings);
  api::Router router(scheduler, {config.keys});
  HttpServer http(router, blobs, metrics, config.http);

  const int port = http.bind();
  scheduler.start();
  const std::jthread listener([&] {
    try {
      http.serve();
    } catch (const Error& error) {
      log_event(Level::error, "http", {{"reason", error.message()}});
      stop_requested.release();
    }
  });
  log_event(Level::info, "listening", {{"address", "http://" + config.http.host + ":" + std::to_string(port)}});
  stop_requested.acquire();
  log_event(Level::info, "draining");
  scheduler.drain(config.drain); // meanwhile requests are answered, new jobs with 503
  http.stop();
  log_event(Level::info, "stopped");
  return 0;
}

} // namespace orbis::server
