// Runs the jobs: a bounded queue, N workers, cancellation, draining, and taking up after a restart.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "api/job_service.h"
#include "server/blob_store.h"
#include "server/job_runner.h"
#include "server/job_store.h"
#include "server/metrics.h"
#include "server/time_to_go.h"
#include "server/ulid.h"

namespace orbis::server {

struct SchedulerSettings {
  std::uint32_t workers = 1;
  std::size_t queue = 64; // jobs that may wait
  JobLimits limits;
  std::chrono::seconds time_to_live{24 * 3600}; // of a finished job's files
  std::uint32_t attempts = 3;                   // a job that was interrupted this often has failed
  bool cache = true;                            // a request that was answered before is answered from there
  std::string build; // tells this program from others: their results and checkpoints are not its own
};

class Scheduler final : public api::JobService {
public:
  // Takes up what an earlier run has left: queued and interrupted jobs run again. start() starts the workers.
  Scheduler(JobStore& store, BlobStore& blobs, JobRunner& runner, Metrics& metrics, const SchedulerSettings& settings);
  ~Scheduler() override;
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  void start();
  // Takes no more jobs; gives those that run `grace` to finish, then stops them. They and the queued ones stay queued
  // on disk. Returns when nothing runs. Final.
  void drain(std::chrono::milliseconds grace);
  // Deletes the files of jobs whose time is over at `time`. A thread of the scheduler does so every minute.
  void collect_garbage(api::Time time);

  [[nodiscard]] api::Job submit(api::Submission submission) override;
  [[nodiscard]] std::optional<api::Job> find(std::string_view id) override;
  [[nodiscard]] std::optional<api::Job> wait(std::string_view id, std::uint64_t version,
                                             std::chrono::milliseconds timeout) override;
  [[nodiscard]] api::JobPage list(const api::JobQuery& query) override;
  [[nodiscard]] std::optional<api::Job> cancel(std::string_view id) override;
  [[nodiscard]] std::optional<api::StoredFile> file(std::string_view id, api::JobFile kind) override;
  [[nodiscard]] std::optional<api::StoredFile> map(std::string_view id, std::string_view name) override;
  [[nodiscard]] bool has_room(std::string_view idempotency_key) override;
  [[nodiscard]] bool draining() const override { return draining_; }
  [[nodiscard]] bool stopped() const override { return stopped_; }
  void note_refusal() override { metrics_.job_refused(); }
  [[nodiscard]] std::chrono::seconds retry_after() const override;
  [[nodiscard]] std::string metrics() const override;

private:
  using Lock = std::unique_lock<std::mutex>;

  // A job that is queued or running.
  struct Live {
    StoredJob stored;
    std::stop_source stop;
    Milestones milestones;
    std::chrono::steady_clock::time_point started;
  };

  void take_up();
  void work(const std::stop_token& stop);
  void run(const std::string& id, Lock& lock);
  [[nodiscard]] JobTask task_of(const StoredJob& stored) const;
  void begin(Live& live);
  void progress(Live& live, Stage stage, std::uint64_t done, std::uint64_t total);
  void end(Live& live, const JobOutcome& outcome);
  void succeed(Live& live, const JobOutcome& outcome);
  void fail(StoredJob& stored, const Error& error) const;
  void finish(StoredJob& stored, api::JobState state) const;
  void changed(StoredJob& stored);
  void remove_files(const std::string& id);
  void forget_checkpoint(const std::string& id) const;
  [[nodiscard]] std::optional<api::StoredFile> output(std::string_view id, std::string_view name);
  [[nodiscard]] api::Job shown(const StoredJob& stored) const;
  [[nodiscard]] std::optional<api::Job> find_locked(std::string_view id);
  [[nodiscard]] std::optional<api::Job> earlier_submission(const std::string& key, const std::string& fingerprint);
  [[nodiscard]] std::optional<api::Job> answer_from_cache(StoredJob stored);
  void remove_from_queue(const std::string& id);

  JobStore& store_;
  BlobStore& blobs_;
  JobRunner& runner_;
  Metrics& metrics_;
  SchedulerSettings settings_;
  UlidSource ids_;
  std::string checkpoint_file_; // the name under which this build's checkpoints are stored

  std::mutex mutex_; // guards the store and everything below but the atomics
  std::condition_variable_any work_, changes_,
      pause_; // a job to take; a job that changed; never: to sleep until the end
  std::deque<std::string> queue_;
  std::map<std::string, Live, std::less<>> live_;
  TimeToGoModel time_to_go_;
  std::atomic<std::size_t> queued_{0}, running_{0};
  std::atomic<double> mean_wall_ms_{1000};
  std::atomic<bool> draining_{false}, stopped_{false};
  std::vector<std::jthread> threads_;
};

} // namespace orbis::server
