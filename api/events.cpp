#include "api/events.h"

#include <vector>

#include "api/json.h"

namespace orbis::api {
namespace {

std::string event(std::string_view type, const Json& data) {
  return "event: " + std::string(type) + "\ndata: " + dump(data) + "\n\n";
}

} // namespace

std::string events_between(const Job* before, const Job& after) {
  const Json json = to_json(after);
  std::vector<std::string> events;
  const bool stage_changed =
      after.progress && (before == nullptr || !before->progress || before->progress->stage != after.progress->stage);
  if (stage_changed) events.push_back(event("stage", json["progress"]));
  if (after.progress && !is_final(after.state)) events.push_back(event("progress", json["progress"]));
  if (before == nullptr || before->state != after.state) events.push_back(event("state", json));
  std::string text;
  for (const std::string& each : events) {
    if (&each == &events.back()) text.append("id: ").append(std::to_string(after.version)).append("\n");
    text += each;
  }
  return text;
}

StreamBody event_stream(JobService& jobs, std::string id, std::uint64_t last_seen, std::chrono::seconds comment_every,
                        std::shared_ptr<void> slot) {
  struct Stream {
    std::optional<Job> last;
    std::uint64_t seen;
    bool ended = false;
  };
  auto stream = std::make_shared<Stream>(Stream{std::nullopt, last_seen});
  return [&jobs, id = std::move(id), comment_every, slot = std::move(slot), stream]() -> std::optional<std::string> {
    if (stream->ended || jobs.stopped()) return std::nullopt;
    const std::optional<Job> job = jobs.wait(id, stream->seen, comment_every);
    if (!job) return std::nullopt;
    stream->ended = is_final(job->state);
    if (job->version == stream->seen)
      return stream->ended ? std::nullopt : std::optional<std::string>(": still here\n\n");
    std::string text = events_between(stream->last ? &*stream->last : nullptr, *job);
    stream->seen = job->version;
    stream->last = job;
    return text.empty() ? ": no change\n\n" : text;
  };
}

} // namespace orbis::api
