#include "api/router.h"

#include <algorithm>
#include <cstdio>

#include "api/events.h"
#include "api/json.h"
#include "api/openapi.h"
#include "api/preconditions.h"
#include "api/submission.h"

namespace orbis::api {
namespace {

constexpr std::string_view json_type = "application/json";

Response text_response(int status, std::string_view type, std::string body) {
  Response response{status, {}, std::move(body)};
  response.set("Content-Type", std::string(type));
  return response;
}

Response json_response(int status, const Json& json) { return text_response(status, json_type, dump(json)); }

// The job as JSON under its entity tag; 304 where the client has it already.
Response job_response(const Request& request, const Job& job) {
  Response response = json_response(200, to_json(job));
  const std::string etag = etag_of(std::get<std::string>(response.body));
  if (matches_etag(request.header("If-None-Match"), etag)) response = Response{304, {}, std::string{}};
  response.set("ETag", etag);
  response.set("Cache-Control", "no-cache");
  return response;
}

// Equal times for equal lengths, whatever the first difference.
bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned>(a[i] ^ b[i]);
  return difference == 0;
}

std::string server_timing(const Timing& timing) {
  std::string text;
  const auto add = [&](std::string_view name, double ms) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, ";dur=%.1f", ms);
    text += (text.empty() ? "" : ", ") + std::string(name) + buffer;
  };
  if (timing.queue_ms) add("queue", *timing.queue_ms);
  for (const StageTiming& stage : timing.stages) add(stage.name, stage.wall_ms);
  if (timing.wall_ms) add("total", *timing.wall_ms);
  return text;
}

// A ULID: 26 digits in base 32.
bool is_job_id(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
  return text.size() == 26 && text.find_first_not_of(digits) == std::string_view::npos;
}

JobQuery parse_job_query(const Request& request) {
  JobQuery query;
  for (const auto& [name, value] : request.query) {
    if (name == "state") {
      query.state = job_state(value);
      if (!query.state) {
        throw Refused(Refusal::bad_request,
                      "'state' is one of queued, running, succeeded, failed, canceled and expired");
      }
    } else if (name == "limit") {
      query.limit = 0;
      if (value.size() <= 3 && value.find_first_not_of("0123456789") == std::string::npos) {
        for (const char digit : value) query.limit = query.limit * 10 + static_cast<std::size_t>(digit - '0');
      }
      if (query.limit < 1 || query.limit > 100)
        throw Refused(Refusal::bad_request, "'limit' is a number from 1 to 100");
    } else if (name == "cursor") {
      query.cursor = value;
      if (!value.empty() && !is_job_id(value))
        throw Refused(Refusal::bad_request, "'cursor' is the 'next_cursor' of an earlier page");
    } else {
      throw Refused(Refusal::bad_request,
                    "there is no parameter '" + name.substr(0, 64) + "'; there are state, limit and cursor");
    }
  }
  return query;
}

struct FileTraits {
  std::string_view route, type, download_suffix;
  JobFile kind;
};
constexpr FileTraits file_traits[]{
    {"result", "model/gltf-binary", ".glb", JobFile::result},
    {"report", "application/json", "-report.json", JobFile::report},
    {"atlas.png", "image/png", "-atlas.png", JobFile::atlas},
    {"preview.png", "image/png", "-preview.png", JobFile::preview},
};

constexpr FileTraits zipped_result{"result", "application/zip", ".zip", JobFile::result};

const FileTraits& traits_of(const Job& job, JobFile kind) {
  if (kind == JobFile::result && job.options.output == OutputForm::zip) return zipped_result;
  return *std::ranges::find(file_traits, kind, &FileTraits::kind);
}

// The media type of a map, by its name's ending.
std::string_view type_of_map(std::string_view name) {
  if (name.ends_with(".jpeg")) return "image/jpeg";
  return name.ends_with(".webp") ? "image/webp" : "image/png";
}

bool is_read(const Request& request) { return request.method == "GET" || request.method == "HEAD"; }

// A stored file with its entity tag and at most one range.
Response file_response(const Request& request, const StoredFile& file, std::string_view type) {
  const std::string etag = "\"" + file.sha256 + "\"";
  Response response;
  response.set("ETag", etag);
  response.set("Accept-Ranges", "bytes");
  response.set("Cache-Control", "private, immutable");
  if (is_read(request) && matches_etag(request.header("If-None-Match"), etag)) {
    response.status = 304;
    return response;
  }
  const std::string_view if_range = request.header("If-Range");
  const bool range_applies = request.method == "GET" && (if_range.empty() || if_range == etag);
  const RangeRequest range = parse_range(range_applies ? request.header("Range") : std::string_view{}, file.bytes);
  FileBody body{file.path, 0, file.bytes};
  if (range.kind == RangeKind::unsatisfiable) {
    Refused refused(Refusal::range_not_satisfiable, "the file has " + std::to_string(file.bytes) + " bytes");
    Response problem = text_response(416, "application/problem+json", dump(to_json(refused.problem())));
    problem.set("Content-Range", "bytes */" + std::to_string(file.bytes));
    return problem;
  }
  if (range.kind == RangeKind::part) {
    response.status = 206;
    body.offset = range.range.offset;
    body.length = range.range.length;
    response.set("Content-Range", "bytes " + std::to_string(body.offset) + "-" +
                                      std::to_string(body.offset + body.length - 1) + "/" + std::to_string(file.bytes));
  }
  response.set("Content-Type", std::string(type));
  response.body = std::move(body);
  return response;
}

Response method_not_allowed(std::string_view allowed) {
  Response response = text_response(
      405, "application/problem+json",
      dump(to_json(make_problem(Refusal::method_not_allowed, "this address takes " + std::string(allowed)))));
  response.set("Allow", std::string(allowed));
  return response;
}

[[noreturn]] void refuse_unknown_path() {
  throw Refused(Refusal::not_found, "there is nothing at this address; /openapi.json lists what there is");
}

Response problem_page(std::string_view slug) {
  const auto types = problem_types();
  const auto it = std::ranges::find(types, slug, &ProblemType::slug);
  if (it == types.end()) refuse_unknown_path();
  return json_response(200,
                       {{"type", "/problems/" + std::string(it->slug)}, {"title", it->title}, {"status", it->status}});
}

// Holds one of the places for requests that block.
std::shared_ptr<void> take_slot(std::atomic<std::uint32_t>& taken, std::uint32_t limit) {
  if (taken.fetch_add(1) >= limit) {
    taken.fetch_sub(1);
    return nullptr;
  }
  return {&taken, [](void* slots) { static_cast<std::atomic<std::uint32_t>*>(slots)->fetch_sub(1); }};
}

} // namespace

bool is_upload(std::string_view method, std::string_view path) {
  return method == "POST" && (path == "/v1/jobs" || path == "/v1/morphs");
}

Response Router::problem_response(const Problem& problem) const {
  Response response = text_response(problem.status, "application/problem+json", dump(to_json(problem)));
  if (problem.status == 401) response.set("WWW-Authenticate", "Bearer");
  if (problem.status == 429 || problem.status == 503) {
    response.set("Retry-After", std::to_string(jobs_.retry_after().count()));
  }
  return response;
}

std::optional<Response> Router::refuse_early(const Request& head) {
  try {
    if (!is_upload(head.method, head.path)) return handle(head);
    check_key(head);
    check_media_type(head);
    check_capacity(head);
    return std::nullopt;
  } catch (const Refused& refused) {
    return problem_response(refused.problem());
  }
}

Response Router::handle(const Request& request) {
  try {
    return route(request);
  } catch (const Refused& refused) {
    return problem_response(refused.problem());
  } catch (const Error& error) {
    return problem_response(make_problem(error));
  } catch (const std::exception&) {
    // The text of a library's exception is not for clients.
    return problem_response(make_problem(Error(ErrorCode::internal, "the request failed; the log says why")));
  }
}

Response Router::route(const Request& request) {
  const std::string_view path = request.path;
  constexpr std::string_view jobs = "/v1/jobs", morphs = "/v1/morphs", problems = "/problems/";
  if (path == jobs || path.starts_with("/v1/jobs/")) {
    check_key(request);
    if (path == jobs) {
      if (request.method == "POST") return post_job(request, parse_submission);
      return is_read(request) ? list_jobs(request) : method_not_allowed("GET, POST");
    }
    const std::string_view tail = path.substr(jobs.size() + 1);
    const auto slash = std::min(tail.find('/'), tail.size());
    return job_route(request, tail.substr(0, slash), tail.substr(slash));
  }
  if (path.starts_with(problems) && is_read(request)) return problem_page(path.substr(problems.size()));
  if (path == morphs) {
    check_key(request);
    return request.method == "POST" ? post_job(request, parse_morph) : method_not_allowed("POST");
  }
  const bool known = path == "/livez" || path == "/readyz" || path == "/metrics" || path == "/openapi.json";
  if (!known) refuse_unknown_path();
  if (!is_read(request)) return method_not_allowed("GET");
  if (path == "/livez") return text_response(200, "text/plain; charset=utf-8", "ok\n");
  if (path == "/readyz") return readiness();
  if (path == "/metrics") return text_response(200, "text/plain; version=0.0.4; charset=utf-8", jobs_.metrics());
  return text_response(200, json_type, std::string(openapi_json));
}

Response Router::job_route(const Request& request, std::string_view id, std::string_view rest) {
  if (rest.empty()) {
    if (is_read(request)) return get_job(request, id);
    return request.method == "DELETE" ? delete_job(id) : method_not_allowed("GET, DELETE");
  }
  rest.remove_prefix(1);
  constexpr std::string_view maps = "maps/";
  if (rest.starts_with(maps)) {
    return is_read(request) ? get_map(request, id, rest.substr(maps.size())) : method_not_allowed("GET");
  }
  const auto* file = std::ranges::find(file_traits, rest, &FileTraits::route);
  if (rest != "events" && file == std::end(file_traits)) refuse_unknown_path();
  if (!is_read(request)) return method_not_allowed("GET");
  return rest == "events" ? get_events(request, id) : get_file(request, id, file->kind);
}

void Router::check_key(const Request& request) const {
  if (settings_.keys.empty()) return;
  const std::string_view header = request.header("Authorization");
  constexpr std::string_view scheme = "Bearer ";
  if (header.size() < scheme.size() || !equal_ignoring_case(header.substr(0, scheme.size()), scheme)) {
    throw Refused(Refusal::unauthorized, "send the header 'Authorization: Bearer <key>'");
  }
  const std::string_view key = trim(header.substr(scheme.size()));
  const bool accepted =
      std::ranges::any_of(settings_.keys, [&](const std::string& k) { return equal_in_constant_time(k, key); });
  if (!accepted) throw Refused(Refusal::forbidden, "this key is not accepted here");
}

void Router::check_capacity(const Request& request) const {
  if (jobs_.draining()) throw Refused(Refusal::draining, "the service is shutting down; try again soon");
  if (jobs_.has_room(request.header("Idempotency-Key"))) return;
  jobs_.note_refusal();
  throw Refused(Refusal::queue_full, "all places in the queue are taken; try again later");
}

Response Router::readiness() const {
  if (jobs_.draining()) throw Refused(Refusal::draining, "the service is shutting down and takes no more jobs");
  return text_response(200, "text/plain; charset=utf-8", "ok\n");
}

Job Router::require(std::string_view id) const {
  if (auto job = jobs_.find(id)) return *std::move(job);
  throw Refused(Refusal::not_found, "there is no job '" + std::string(id.substr(0, 64)) + "'");
}

// Says in the answer that it waited, unless too many others do.
template <class Done> Job Router::wait_until(Job job, std::chrono::seconds time, std::string& applied, Done done) {
  using Clock = std::chrono::steady_clock;
  const auto slot = take_slot(waiting_, settings_.max_waiting);
  time = std::min(time, settings_.max_wait);
  if (slot) applied = "wait=" + std::to_string(time.count());
  const auto end = Clock::now() + time;
  while (slot && !done(job) && !jobs_.stopped()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0) break;
    auto changed = jobs_.wait(job.id, job.version, left);
    if (!changed) break;
    job = *std::move(changed);
  }
  return job;
}

Response Router::post_job(const Request& request, Submission (*parse)(const Request&)) {
  check_media_type(request);
  const auto wait = preferred_wait(request.header("Prefer"));
  Job job = jobs_.submit(parse(request));
  const std::string address = "/v1/jobs/" + job.id;
  Response response;
  std::string applied;
  if (wait) job = wait_until(std::move(job), *wait, applied, [](const Job& j) { return is_final(j.state); });
  if (wait && is_final(job.state)) {
    response = result_of(request, job, JobFile::result);
  } else {
    response = json_response(202, to_json(job));
    response.set("Retry-After", "1");
  }
  if (!applied.empty()) response.set("Preference-Applied", applied);
  response.set("Location", address);
  return response;
}

Response Router::get_job(const Request& request, std::string_view id) {
  Job job = require(id);
  const auto wait = preferred_wait(request.header("Prefer"));
  std::string applied;
  if (wait) {
    const auto stage_of = [](const Job& j) { return j.progress ? static_cast<int>(j.progress->stage) : -1; };
    const auto state = job.state;
    const int stage = stage_of(job);
    job = wait_until(std::move(job), *wait, applied,
                     [&](const Job& j) { return is_final(j.state) || j.state != state || stage_of(j) != stage; });
  }
  Response response = job_response(request, job);
  if (!applied.empty()) response.set("Preference-Applied", applied);
  return response;
}

Response Router::delete_job(std::string_view id) {
  const auto job = jobs_.cancel(id);
  if (!job) (void)require(id);
  return json_response(200, to_json(*job));
}

Response Router::list_jobs(const Request& request) {
  const JobQuery query = parse_job_query(request);
  const JobPage page = jobs_.list(query);
  Response response = json_response(200, to_json(page));
  if (!page.next_cursor.empty()) {
    std::string next = "/v1/jobs?limit=" + std::to_string(query.limit) + "&cursor=" + page.next_cursor;
    if (query.state) next += "&state=" + std::string(name_of(*query.state));
    response.set("Link", "<" + next + ">; rel=\"next\"");
  }
  return response;
}

Response Router::get_file(const Request& request, std::string_view id, JobFile kind) {
  return result_of(request, require(id), kind);
}

Response Router::get_map(const Request& request, std::string_view id, std::string_view name) {
  const Job job = require(id);
  if (auto refusal = refuse_unfinished(job)) return *std::move(refusal);
  const auto file = jobs_.map(job.id, name);
  if (!file) throw Refused(Refusal::not_found, "the job has no map of this name; its links list those that it has");
  return file_response(request, *file, type_of_map(name));
}

std::optional<Response> Router::refuse_unfinished(const Job& job) const {
  const auto refuse = [&](Problem problem) {
    problem.instance = "/v1/jobs/" + job.id;
    return problem_response(problem);
  };
  switch (job.state) {
  case JobState::queued:
  case JobState::running:
    return refuse(make_problem(Refusal::not_finished, "the job is " + std::string(name_of(job.state)) +
                                                          "; wait for it with 'Prefer: wait=30' on the job"));
  case JobState::expired:
    return refuse(make_problem(Refusal::expired, "the job's files were deleted when it expired; post the model again"));
  case JobState::canceled:
    return refuse(make_problem(Error(ErrorCode::canceled, "the job was canceled")));
  case JobState::failed:
    return refuse(job.problem.value());
  case JobState::succeeded:
    break;
  }
  return std::nullopt;
}

Response Router::result_of(const Request& request, const Job& job, JobFile kind) {
  if (auto refusal = refuse_unfinished(job)) return *std::move(refusal);
  const auto file = jobs_.file(job.id, kind);
  if (!file) throw Refused(Refusal::expired, "the job expired just now; post the model again");
  const FileTraits& traits = traits_of(job, kind);
  Response response = file_response(request, *file, traits.type);
  if (kind == JobFile::result && response.status < 400) {
    response.set("Content-Disposition",
                 "attachment; filename=\"orbis-" + job.id + std::string(traits.download_suffix) + "\"");
    if (const std::string timing = server_timing(job.timing); !timing.empty()) response.set("Server-Timing", timing);
  }
  return response;
}

Response Router::get_events(const Request& request, std::string_view id) {
  const Job job = require(id);
  std::uint64_t last_seen = 0;
  for (const char digit : request.header("Last-Event-ID")) {
    if (digit < '0' || digit > '9')
      throw Refused(Refusal::bad_request, "Last-Event-ID is the id of an event: a number");
    last_seen = last_seen * 10 + static_cast<std::uint64_t>(digit - '0');
  }
  // All was seen: 204 tells an EventSource not to come back.
  if (is_final(job.state) && last_seen == job.version) return Response{204, {}, std::string{}};
  auto slot = take_slot(waiting_, settings_.max_waiting);
  if (!slot) throw Refused(Refusal::too_many_waiting, "too many clients wait for jobs; poll this one instead");
  Response response;
  response.set("Content-Type", "text/event-stream");
  response.set("Cache-Control", "no-store");
  response.body = event_stream(jobs_, job.id, last_seen, settings_.event_comment, std::move(slot));
  return response;
}

} // namespace orbis::api
