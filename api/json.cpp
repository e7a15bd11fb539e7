#include "api/json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace orbis::api {
namespace {

// Options are numbers and truth values in JSON where they are in C++: what reads as one is one, but for a list of one.
Json option_value(const Options& options, std::string_view name) {
  const std::string text = get_option(options, name);
  if (name == "lods" || name == "morph_to") return text;
  const Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_number() || parsed.is_boolean() ? parsed : Json(text);
}

template <class T> Json optional_value(const std::optional<T>& value) { return value ? Json(*value) : Json(nullptr); }

Json optional_time(const std::optional<Time>& time) { return time ? Json(rfc3339(*time)) : Json(nullptr); }

// Milliseconds to the microsecond: the digits behind are noise.
double rounded(double milliseconds) { return std::round(milliseconds * 1e3) / 1e3; }

Json optional_ms(const std::optional<double>& milliseconds) {
  return milliseconds ? Json(rounded(*milliseconds)) : Json(nullptr);
}

Json links(const Job& job, const std::string& self) {
  Json json{{"self", self}, {"events", self + "/events"}};
  if (job.state == JobState::succeeded) {
    for (const char* name : {"result", "report", "atlas.png", "preview.png"}) json[name] = self + "/" + name;
    json["maps"] = Json::object();
    const std::string maps = self + "/maps/";
    for (const std::string& map : job.maps) json["maps"][map] = maps + map;
  }
  return json;
}

Json input_json(const JobInput& input) {
  return {{"sha256", input.sha256}, {"bytes", input.bytes}, {"triangles", optional_value(input.triangles)}};
}

template <class T> std::optional<T> read_optional(const Json& json, const char* name) {
  const auto it = json.find(name);
  if (it == json.end() || it->is_null()) return std::nullopt;
  return it->get<T>();
}

} // namespace

Json to_json(const Options& options) {
  Json json = Json::object();
  for (const OptionInfo& info : option_table()) json[std::string(info.name)] = option_value(options, info.name);
  return json;
}

Options options_from_json(const Json& json) {
  Options options;
  for (const auto& [name, value] : json.items()) {
    set_option(options, name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return options;
}

Json to_json(const JobProgress& progress) {
  Json eta = nullptr;
  if (progress.eta_ms) eta = {{"p50", rounded(progress.eta_ms->p50)}, {"p90", rounded(progress.eta_ms->p90)}};
  return {{"percent", std::round(progress.percent * 10) / 10},
          {"stage", name_of(progress.stage)},
          {"stage_index", static_cast<std::size_t>(progress.stage) + 1},
          {"stages", stage_count},
          {"done", progress.done},
          {"total", progress.total},
          {"eta_ms", std::move(eta)}};
}

JobProgress progress_from_json(const Json& json) {
  JobProgress progress;
  const auto* stage = std::ranges::find(stage_names, json.at("stage").get<std::string>());
  if (stage == stage_names.end()) throw Error(ErrorCode::internal, "there is no such stage");
  progress.stage = static_cast<Stage>(stage - stage_names.begin());
  json.at("done").get_to(progress.done);
  json.at("total").get_to(progress.total);
  json.at("percent").get_to(progress.percent);
  return progress;
}

Json to_json(const Timing& timing) {
  Json stages = Json::array();
  for (const StageTiming& stage : timing.stages) {
    stages.push_back({{"name", stage.name}, {"wall_ms", rounded(stage.wall_ms)}, {"cpu_ms", rounded(stage.cpu_ms)}});
  }
  return {{"queue_ms", optional_ms(timing.queue_ms)},
          {"wall_ms", optional_ms(timing.wall_ms)},
          {"cpu_ms", optional_ms(timing.cpu_ms)},
          {"peak_rss_bytes", optional_value(timing.peak_rss_bytes)},
          {"stages", std::move(stages)}};
}

Timing timing_from_json(const Json& json) {
  Timing timing;
  timing.queue_ms = read_optional<double>(json, "queue_ms");
  timing.wall_ms = read_optional<double>(json, "wall_ms");
  timing.cpu_ms = read_optional<double>(json, "cpu_ms");
  timing.peak_rss_bytes = read_optional<std::uint64_t>(json, "peak_rss_bytes");
  for (const Json& stage : json.at("stages")) {
    timing.stages.push_back(
        {stage.at("name").get<std::string>(), stage.at("wall_ms").get<double>(), stage.at("cpu_ms").get<double>()});
  }
  return timing;
}

Json to_json(const Problem& problem) {
  Json json{{"type", "/problems/" + problem.slug},
            {"title", problem.title},
            {"status", problem.status},
            {"detail", problem.detail}};
  if (!problem.instance.empty()) json["instance"] = problem.instance;
  if (!problem.errors.empty()) {
    Json errors = Json::array();
    for (const FieldError& error : problem.errors) {
      errors.push_back({{"pointer", error.pointer}, {"detail", error.detail}});
    }
    json["errors"] = std::move(errors);
  }
  return json;
}

Problem problem_from_json(const Json& json) {
  Problem problem;
  problem.slug = json.at("type").get<std::string>().substr(std::string_view("/problems/").size());
  problem.title = json.at("title").get<std::string>();
  problem.status = json.at("status").get<int>();
  problem.detail = json.at("detail").get<std::string>();
  problem.instance = json.value("instance", "");
  for (const Json& error : json.value("errors", Json::array())) {
    problem.errors.push_back({error.at("pointer").get<std::string>(), error.at("detail").get<std::string>()});
  }
  return problem;
}

Json to_json(const Job& job) {
  const std::string self = "/v1/jobs/" + job.id;
  Json json{{"id", job.id},
            {"state", name_of(job.state)},
            {"created", rfc3339(job.created)},
            {"started", optional_time(job.started)},
            {"finished", optional_time(job.finished)},
            {"expires", optional_time(job.expires)},
            {"queue_position", optional_value(job.queue_position)},
            {"attempt", job.attempt},
            {"cached", job.cached},
            {"partial", job.partial},
            {"progress", job.progress ? to_json(*job.progress) : Json(nullptr)},
            {"timing", to_json(job.timing)},
            {"options", to_json(job.options)},
            {"input", input_json(job.input)}};
  json["result"] = nullptr;
  if (job.result) {
    json["result"] = {{"sha256", job.result->sha256}, {"bytes", job.result->bytes}, {"href", self + "/result"}};
  }
  json["problem"] = job.problem ? to_json(*job.problem) : Json(nullptr);
  json["links"] = links(job, self);
  return json;
}

Json to_json(const JobPage& page) {
  Json items = Json::array();
  for (const Job& job : page.items) items.push_back(to_json(job));
  return {{"items", std::move(items)},
          {"next_cursor", page.next_cursor.empty() ? Json(nullptr) : Json(page.next_cursor)}};
}

std::string rfc3339(Time time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{time - day};
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return text.data();
}

std::string dump(const Json& json, int indent) { return json.dump(indent, ' ', false, Json::error_handler_t::replace); }

} // namespace orbis::api
