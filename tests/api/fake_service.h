// A job service that does what a test tells it to: jobs change only when the test changes them.
#pragma once

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "api/job_service.h"

namespace orbis::test {

class FakeService final : public api::JobService {
public:
  std::map<std::string, api::Job, std::less<>> jobs;
  std::map<api::JobFile, api::StoredFile> files;
  std::map<std::string, api::StoredFile, std::less<>> maps;
  std::vector<api::Submission> submissions;
  bool is_draining = false, is_stopped = false, is_full = false;
  int refusals = 0;
  std::string known_key;
  // What happens to a submitted job at once.
  std::function<void(api::Job&)> on_submit = [](api::Job&) {};
  // What happens to a job while someone waits for it.
  std::function<void(api::Job&)> on_wait = [](api::Job&) {};

  api::Job submit(api::Submission submission) override {
    if (is_draining) throw api::Refused(api::Refusal::draining, "shutting down");
    if (!has_room(submission.idempotency_key)) throw api::Refused(api::Refusal::queue_full, "full");
    api::Job job;
    job.id = "01J0000000000000000000000" + std::to_string(jobs.size() % 10);
    job.created = api::Time(std::chrono::milliseconds(1'700'000'000'123));
    job.options = submission.options;
    job.input = {std::string(64, 'a'), submission.model.bytes, std::nullopt};
    job.queue_position = 1;
    job.version = 1;
    submissions.push_back(std::move(submission));
    on_submit(job);
    return jobs[job.id] = job;
  }
  std::optional<api::Job> find(std::string_view id) override {
    const auto it = jobs.find(id);
    return it == jobs.end() ? std::nullopt : std::optional(it->second);
  }
  std::optional<api::Job> wait(std::string_view id, std::uint64_t, std::chrono::milliseconds) override {
    const auto it = jobs.find(id);
    if (it == jobs.end()) return std::nullopt;
    on_wait(it->second);
    return it->second;
  }
  api::JobPage list(const api::JobQuery& query) override {
    api::JobPage page;
    for (auto it = jobs.rbegin(); it != jobs.rend(); ++it) {
      if (!query.cursor.empty() && it->first >= query.cursor) continue;
      if (query.state && it->second.state != *query.state) continue;
      if (page.items.size() == query.limit) {
        page.next_cursor = page.items.back().id;
        break;
      }
      page.items.push_back(it->second);
    }
    return page;
  }
  std::optional<api::Job> cancel(std::string_view id) override {
    const auto it = jobs.find(id);
    if (it == jobs.end()) return std::nullopt;
    if (!is_final(it->second.state)) it->second.state = api::JobState::canceled;
    return it->second;
  }
  std::optional<api::StoredFile> file(std::string_view, api::JobFile kind) override {
    const auto it = files.find(kind);
    return it == files.end() ? std::nullopt : std::optional(it->second);
  }
  std::optional<api::StoredFile> map(std::string_view, std::string_view name) override {
    const auto it = maps.find(name);
    return it == maps.end() ? std::nullopt : std::optional(it->second);
  }
  [[nodiscard]] bool stopped() const override { return is_stopped; }
  void note_refusal() override { ++refusals; }
  [[nodiscard]] bool draining() const override { return is_draining; }
  [[nodiscard]] bool has_room(std::string_view idempotency_key) override {
    return !is_full || (!idempotency_key.empty() && idempotency_key == known_key);
  }
  [[nodiscard]] std::chrono::seconds retry_after() const override { return std::chrono::seconds(7); }
  [[nodiscard]] std::string metrics() const override { return "orbis_jobs_queued 0\n"; }
};

} // namespace orbis::test
