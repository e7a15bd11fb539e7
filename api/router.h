// The routes of the contract (openapi.yaml): a request in, a response out.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "api/http.h"
#include "api/job_service.h"

namespace orbis::api {

struct RouterSettings {
  std::vector<std::string> keys;          // accepted bearer keys; empty: no key is asked for
  std::chrono::seconds max_wait{120};     // the longest Prefer: wait that is honoured
  std::uint32_t max_waiting = 64;         // requests that may block at a time; more are answered at once
  std::chrono::seconds event_comment{15}; // a comment on an idle event stream, so that proxies keep it open
};

// Whether the request brings models: its body is spooled before it is handled.
[[nodiscard]] bool is_upload(std::string_view method, std::string_view path);

// Thread-safe.
class Router {
public:
  Router(JobService& jobs, RouterSettings settings) : jobs_(jobs), settings_(std::move(settings)) {}

  // What can be refused before a body is read: keys, routes, media types, a full queue. Nothing: go on and read it.
  [[nodiscard]] std::optional<Response> refuse_early(const Request& head);

  // Never throws; what goes wrong is a problem document.
  [[nodiscard]] Response handle(const Request& request);

private:
  [[nodiscard]] Response route(const Request& request);
  [[nodiscard]] Response job_route(const Request& request, std::string_view id, std::string_view rest);
  void check_key(const Request& request) const;
  void check_capacity(const Request& request) const;

  // Starts the job that a POST to /v1/jobs or /v1/morphs asks for.
  [[nodiscard]] Response post_job(const Request& request, Submission (*parse)(const Request&));
  [[nodiscard]] Response get_job(const Request& request, std::string_view id);
  [[nodiscard]] Response delete_job(std::string_view id);
  [[nodiscard]] Response list_jobs(const Request& request);
  [[nodiscard]] Response get_file(const Request& request, std::string_view id, JobFile kind);
  [[nodiscard]] Response get_map(const Request& request, std::string_view id, std::string_view name);
  [[nodiscard]] Response get_events(const Request& request, std::string_view id);
  [[nodiscard]] Response readiness() const;
  [[nodiscard]] Response problem_response(const Problem& problem) const;

  [[nodiscard]] Job require(std::string_view id) const;
  [[nodiscard]] Response result_of(const Request& request, const Job& job, JobFile kind);
  // Why there are no files of the job; nothing where it has succeeded.
  [[nodiscard]] std::optional<Response> refuse_unfinished(const Job& job) const;
  // Waits until `done` holds for the job or the time is over.
  template <class Done> Job wait_until(Job job, std::chrono::seconds time, std::string& applied, Done done);

  JobService& jobs_;
  RouterSettings settings_;
  std::atomic<std::uint32_t> waiting_{0};
};

} // namespace orbis::api
