// One run of one job: what the scheduler's workers do.
#include <algorithm>

#include "api/json.h"
#include "server/job_files.h"
#include "server/job_log.h"
#include "server/scheduler.h"

namespace orbis::server {
namespace {

using api::Job;
using api::JobState;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

// Called and left with the lock held; the job itself runs without it.
void Scheduler::run(const std::string& id, Lock& lock) {
  Live& live = live_.at(id); // stays where it is: only its worker erases a running job
  begin(live);
  const JobTask task = task_of(live.stored);
  const JobHooks hooks{[&](Stage stage, std::uint64_t done, std::uint64_t total) {
                         const Lock progress_lock(mutex_);
                         progress(live, stage, done, total);
                       },
                       [&](std::string_view name) {
                         if (name == checkpoint_name) return blobs_.output_path(id, checkpoint_file_);
                         return is_result(name) ? blobs_.output_path(id, name) : std::filesystem::path();
                       }};
  const std::stop_token stop = live.stop.get_token();
  lock.unlock();
  JobOutcome outcome;
  try {
    outcome = runner_.run(task, hooks, stop);
  } catch (const Error& error) {
    outcome.error = error;
  }
  lock.lock();
  end(live, outcome);
  live_.erase(id);
}

JobTask Scheduler::task_of(const StoredJob& stored) const {
  JobTask task;
  task.options = stored.job.options;
  task.limits = settings_.limits;
  for (std::size_t i = 0; i < stored.inputs.size(); ++i) {
    InputFile file{stored.inputs[i].name, blobs_.input_path(stored.job.id, i), stored.inputs[i].bytes};
    if (i == 0)
      task.model = std::move(file);
    else
      task.files.push_back(std::move(file));
  }
  if (const auto bytes = blobs_.output_size(stored.job.id, checkpoint_file_)) {
    task.checkpoint =
        InputFile{std::string(checkpoint_name), blobs_.output_path(stored.job.id, checkpoint_file_), *bytes};
  }
  return task;
}

void Scheduler::begin(Live& live) {
  Job& job = live.stored.job;
  job.state = JobState::running;
  job.started = api::now();
  ++job.attempt;
  job.timing.queue_ms = static_cast<double>(std::max<std::int64_t>(0, (*job.started - job.created).count()));
  live.started = std::chrono::steady_clock::now();
  changed(live.stored);
  log_job("job_started", job);
}

// In memory only until the job ends: it is worth nothing after a restart.
void Scheduler::progress(Live& live, Stage stage, std::uint64_t done, std::uint64_t total) {
  Job& job = live.stored.job;
  if (is_final(job.state)) return;
  const double before = job.progress ? job.progress->percent : 0.0;
  const double percent = std::max(before, std::min(99.9, api::overall_percent(stage, done, total)));
  const double elapsed = milliseconds_since(live.started);
  live.milestones.reach(percent, elapsed);
  job.progress =
      api::JobProgress{stage, std::min(done, total), total, percent, time_to_go_.estimate(live.milestones, elapsed)};
  job.timing.wall_ms = elapsed;
  ++job.version;
  changes_.notify_all();
}

void Scheduler::end(Live& live, const JobOutcome& outcome) {
  StoredJob& stored = live.stored;
  stored.job.timing.wall_ms = outcome.wall_ms;
  stored.job.timing.cpu_ms = outcome.cpu_ms;
  if (outcome.peak_rss_bytes > 0) stored.job.timing.peak_rss_bytes = outcome.peak_rss_bytes;
  const bool canceled = stored.job.state == JobState::canceled;
  if (!canceled && !outcome.error) {
    succeed(live, outcome);
  } else if (!canceled && outcome.error->code() == ErrorCode::canceled && draining_) {
    stored.job.state = JobState::queued; // for the next run of the service
    stored.job.started.reset();
    stored.job.progress.reset();
    stored.job.timing = {};
  } else if (!canceled) {
    fail(stored, *outcome.error);
  }
  changed(stored);
  log_job("job_ended", stored.job);
  if (is_final(stored.job.state)) metrics_.job_finished(stored.job);
  if (canceled) forget_checkpoint(stored.job.id); // the last may have come after the request
}

void Scheduler::succeed(Live& live, const JobOutcome& outcome) {
  StoredJob& stored = live.stored;
  try {
    take_results(stored, outcome, blobs_.output_path(stored.job.id, "report.json"));
  } catch (const Error& error) {
    stored.outputs.clear();
    stored.job.maps.clear();
    return fail(stored, error);
  }
  if (stored.job.progress) {
    stored.job.progress->percent = 100;
    stored.job.progress->eta_ms.reset();
  }
  finish(stored, JobState::succeeded);
  time_to_go_.learn(live.milestones, outcome.wall_ms);
  mean_wall_ms_ = 0.8 * mean_wall_ms_ + 0.2 * outcome.wall_ms;
}

} // namespace orbis::server
