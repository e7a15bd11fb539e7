#include "server/scheduler.h"

#include <algorithm>
#include <cmath>

#include "server/job_files.h"
#include "server/job_log.h"
#include "server/log.h"

namespace orbis::server {

using api::Job;
using api::JobState;

namespace {

bool is_expired(const Job& job, api::Time time) {
  return job.state == JobState::expired || (job.expires && *job.expires <= time);
}

// Nothing is left of it but that it was there.
void expire(Job& job) {
  job.state = JobState::expired;
  job.result.reset();
  job.maps.clear();
}

} // namespace

Scheduler::Scheduler(JobStore& store, BlobStore& blobs, JobRunner& runner, Metrics& metrics,
                     const SchedulerSettings& settings)
    : store_(store), blobs_(blobs), runner_(runner), metrics_(metrics), settings_(settings),
      checkpoint_file_(std::string(checkpoint_name) + '-' + settings.build.substr(0, 16)) {
  take_up();
}

Scheduler::~Scheduler() { drain(std::chrono::milliseconds(0)); }

void Scheduler::start() {
  for (std::uint32_t i = 0; i < settings_.workers; ++i) {
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  }
  threads_.emplace_back([this](const std::stop_token& stop) {
    Lock lock(mutex_);
    while (!stop.stop_requested()) {
      lock.unlock();
      collect_garbage(api::now());
      lock.lock();
      pause_.wait_for(lock, stop, std::chrono::minutes(1), [] { return false; });
    }
  });
}

// Queued jobs stay queued; running ones were interrupted. A job that goes down with the service too often is given up.
void Scheduler::take_up() {
  for (StoredJob& stored : store_.unfinished()) {
    if (stored.job.state == JobState::running && stored.job.attempt >= settings_.attempts) {
      fail(stored, Error(ErrorCode::internal, "the job was interrupted " + std::to_string(stored.job.attempt) +
                                                  " times; it is not tried again"));
      changed(stored);
      continue;
    }
    stored.job.state = JobState::queued;
    stored.job.started.reset();
    stored.job.progress.reset();
    changed(stored);
    queue_.push_back(stored.job.id);
    std::string id = stored.job.id;
    live_[std::move(id)].stored = std::move(stored);
  }
  queued_ = queue_.size();
  for (const std::string& id : blobs_.jobs()) {
    if (!store_.find(id)) blobs_.remove(id);
  }
}

void Scheduler::drain(std::chrono::milliseconds grace) {
  Lock lock(mutex_);
  draining_ = true;
  changes_.notify_all();
  changes_.wait_for(lock, grace, [this] { return running_ == 0; });
  for (auto& [id, live] : live_) {
    if (live.stored.job.state == JobState::running) live.stop.request_stop();
  }
  lock.unlock();
  threads_.clear(); // stops and joins
  stopped_ = true;
  lock.lock();
  changes_.notify_all();
}

void Scheduler::collect_garbage(api::Time time) {
  const Lock lock(mutex_);
  for (StoredJob& stored : store_.due(time)) {
    expire(stored.job);
    stored.outputs.clear();
    changed(stored);
    remove_files(stored.job.id);
    log_job("job_expired", stored.job);
  }
  store_.forget_expired(time - std::chrono::days(30));
}

void Scheduler::remove_files(const std::string& id) {
  try {
    blobs_.remove(id);
  } catch (const Error& error) {
    // The store has logged why. Files without a job are removed at the next start.
    log_event(Level::warning, "files_left", {{"job", id}, {"reason", error.message()}});
  }
}

// Gives the job its next version, writes it down and wakes those who wait for it.
void Scheduler::changed(StoredJob& stored) {
  // Microseconds since 1970: versions also grow over a restart.
  const auto time =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch());
  stored.job.version = std::max(stored.job.version + 1, static_cast<std::uint64_t>(time.count()));
  store_.update(stored);
  changes_.notify_all();
}

void Scheduler::finish(StoredJob& stored, JobState state) const {
  stored.job.state = state;
  stored.job.finished = api::now();
  stored.job.expires = *stored.job.finished + settings_.time_to_live;
  forget_checkpoint(stored.job.id);
}

void Scheduler::forget_checkpoint(const std::string& id) const {
  try {
    blobs_.remove_output(id, checkpoint_file_);
  } catch (const Error& error) {
    log_event(Level::warning, "files_left", {{"job", id}, {"reason", error.message()}}); // they go with the job
  }
}

void Scheduler::fail(StoredJob& stored, const Error& error) const {
  stored.job.problem = api::make_problem(error);
  stored.job.problem->instance = "/v1/jobs/" + stored.job.id;
  finish(stored, JobState::failed);
}

std::optional<Job> Scheduler::earlier_submission(const std::string& key, const std::string& fingerprint) {
  if (key.empty()) return std::nullopt;
  const auto earlier = store_.find_by_key(key);
  if (!earlier) return std::nullopt;
  if (is_expired(earlier->job, api::now())) { // nothing is left that the key could stand for
    store_.release_key(earlier->job.id);
    return std::nullopt;
  }
  if (earlier->fingerprint != fingerprint) {
    throw api::Refused(api::Refusal::key_reused,
                       "this Idempotency-Key came with another model or other options before; use a new key");
  }
  return find_locked(earlier->job.id);
}

bool Scheduler::has_room(std::string_view idempotency_key) {
  if (queued_ < settings_.queue) return true;
  if (idempotency_key.empty()) return false;
  const Lock lock(mutex_);
  return store_.find_by_key(idempotency_key).has_value();
}

Job Scheduler::submit(api::Submission submission) {
  const Lock lock(mutex_);
  if (draining_) throw api::Refused(api::Refusal::draining, "the service is shutting down; try again soon");
  StoredJob stored = new_job(submission, ids_.next(api::now()), settings_.build);
  if (auto earlier = earlier_submission(stored.idempotency_key, stored.fingerprint)) return *std::move(earlier);
  if (settings_.cache) {
    if (auto answered = answer_from_cache(stored)) return *std::move(answered);
  }
  if (queued_ >= settings_.queue) {
    metrics_.job_refused();
    throw api::Refused(api::Refusal::queue_full,
                       "all " + std::to_string(settings_.queue) + " places in the queue are taken; try again later");
  }
  const std::string id = stored.job.id;
  blobs_.adopt(id, 0, submission.model);
  for (std::size_t i = 0; i < submission.files.size(); ++i) blobs_.adopt(id, i + 1, submission.files[i]);
  stored.job.version = 1;
  store_.insert(stored);
  changed(stored);
  queue_.push_back(id);
  queued_ = queue_.size();
  Live& live = live_[id];
  live.stored = std::move(stored);
  metrics_.job_accepted();
  log_job("job_queued", live.stored.job);
  work_.notify_one();
  return shown(live.stored);
}

// A job of its own, done at once, with the files of an earlier one that was asked for the same.
std::optional<Job> Scheduler::answer_from_cache(StoredJob stored) {
  const auto earlier = store_.find_result(stored.cache_key);
  if (!earlier) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& [name, file] : earlier->outputs) names.push_back(name);
  try {
    blobs_.share(earlier->job.id, stored.job.id, names);
  } catch (const Error& error) {
    // The store has logged why. The result can be made again.
    remove_files(stored.job.id);
    return std::nullopt;
  }
  stored.outputs = earlier->outputs;
  stored.inputs.clear(); // the upload is not kept: nothing will read it
  stored.job.input.triangles = earlier->job.input.triangles;
  stored.job.result = earlier->job.result;
  stored.job.partial = earlier->job.partial;
  stored.job.maps = earlier->job.maps;
  stored.job.cached = true;
  stored.job.started = stored.job.created;
  finish(stored, JobState::succeeded);
  stored.job.version = 1;
  store_.insert(stored);
  changed(stored);
  metrics_.job_cached();
  metrics_.job_finished(stored.job);
  log_job("job_cached", stored.job);
  return stored.job;
}

// The job as clients see it.
Job Scheduler::shown(const StoredJob& stored) const {
  Job job = stored.job;
  if (job.state == JobState::queued) {
    const auto place = std::ranges::find(queue_, job.id);
    if (place != queue_.end()) job.queue_position = static_cast<std::uint64_t>(place - queue_.begin()) + 1;
  }
  return job;
}

std::optional<Job> Scheduler::find_locked(std::string_view id) {
  if (const auto live = live_.find(id); live != live_.end()) return shown(live->second.stored);
  if (auto stored = store_.find(id)) {
    if (is_expired(stored->job, api::now()))
      expire(stored->job); // though its row and files may wait for the collection
    return std::move(stored->job);
  }
  return std::nullopt;
}

std::optional<Job> Scheduler::find(std::string_view id) {
  const Lock lock(mutex_);
  return find_locked(id);
}

std::optional<Job> Scheduler::wait(std::string_view id, std::uint64_t version, std::chrono::milliseconds timeout) {
  Lock lock(mutex_);
  const auto unchanged = [&] {
    const auto live = live_.find(id);
    return live != live_.end() && live->second.stored.job.version == version &&
           !is_final(live->second.stored.job.state) && !stopped_;
  };
  changes_.wait_for(lock, timeout, [&] { return !unchanged(); });
  return find_locked(id);
}

api::JobPage Scheduler::list(const api::JobQuery& query) {
  const Lock lock(mutex_);
  api::JobQuery one_more = query;
  ++one_more.limit;
  api::JobPage page;
  for (const StoredJob& stored : store_.list(one_more)) page.items.push_back(find_locked(stored.job.id).value());
  if (page.items.size() > query.limit) {
    page.items.resize(query.limit);
    page.next_cursor = page.items.back().id;
  }
  return page;
}

void Scheduler::remove_from_queue(const std::string& id) {
  std::erase(queue_, id);
  queued_ = queue_.size();
}

std::optional<Job> Scheduler::cancel(std::string_view id) {
  const Lock lock(mutex_);
  const auto it = live_.find(id);
  if (it == live_.end() || is_final(it->second.stored.job.state)) return find_locked(id);
  StoredJob& stored = it->second.stored;
  const bool was_running = stored.job.state == JobState::running;
  finish(stored, JobState::canceled);
  changed(stored);
  log_job("job_canceled", stored.job);
  Job job = stored.job;
  if (was_running) {
    it->second.stop.request_stop(); // its worker takes it out of live_
  } else {
    metrics_.job_finished(job);
    remove_from_queue(job.id);
    live_.erase(it);
  }
  return job;
}

std::optional<api::StoredFile> Scheduler::file(std::string_view id, api::JobFile kind) {
  return output(id, name_of(kind));
}

std::optional<api::StoredFile> Scheduler::map(std::string_view id, std::string_view name) {
  return output(id, output_of_map(name));
}

std::optional<api::StoredFile> Scheduler::output(std::string_view id, std::string_view name) {
  const Lock lock(mutex_);
  const auto stored = store_.find(id);
  if (!stored || stored->job.state != JobState::succeeded) return std::nullopt;
  if (stored->job.expires && *stored->job.expires <= api::now()) return std::nullopt; // not collected yet
  const auto output = std::ranges::find(stored->outputs, name, [](const auto& o) { return std::string_view(o.first); });
  if (output == stored->outputs.end()) return std::nullopt;
  return api::StoredFile{blobs_.output_path(id, name), output->second.bytes, output->second.sha256};
}

std::chrono::seconds Scheduler::retry_after() const {
  if (draining_) return std::chrono::seconds(5);
  const double seconds = std::ceil(mean_wall_ms_ / 1e3 / settings_.workers);
  return std::chrono::seconds(static_cast<std::int64_t>(std::clamp(seconds, 1.0, 60.0)));
}

std::string Scheduler::metrics() const {
  return metrics_.text({queued_, running_, settings_.workers, settings_.queue, draining_});
}

void Scheduler::work(const std::stop_token& stop) {
  Lock lock(mutex_);
  while (work_.wait(lock, stop, [this] { return !queue_.empty() && !draining_; })) {
    const std::string id = std::move(queue_.front());
    queue_.pop_front();
    queued_ = queue_.size();
    ++running_;
    try {
      run(id, lock);
    } catch (const std::exception& error) {
      // The database or the disk failed under the job: it stays as it is on disk and is taken up at the next start.
      if (!lock.owns_lock()) lock.lock();
      log_event(Level::error, "job_abandoned", {{"job", id}, {"reason", error.what()}});
      live_.erase(id);
    }
    --running_;
    changes_.notify_all();
  }
}

} // namespace orbis::server
