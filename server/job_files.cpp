#include "server/job_files.h"

#include <algorithm>
#include <array>

#include "api/json.h"
#include "server/file_writer.h"
#include "server/sha256.h"

namespace orbis::server {
namespace {

using api::Json;

constexpr std::uint64_t max_report_bytes = 16 << 20;
constexpr std::string_view map_prefix = "map-";
// In the order of api::JobFile.
constexpr std::array<std::string_view, 4> result_names{"result.glb", "report.json", "atlas.png", "preview.png"};

Json contents_of(const api::Submission& submission) {
  Json json{{"options", api::to_json(submission.options)}, {"model", submission.model.sha256}};
  for (const api::Part& part : submission.files) json["files"][part.file_name] = part.sha256;
  return json;
}

std::string cache_key(const api::Submission& submission, std::string_view build) {
  Json json = contents_of(submission);
  json["options"].erase("threads"); // the result does not depend on it
  json["build"] = build;
  return sha256_of(api::dump(json));
}

} // namespace

StoredJob new_job(const api::Submission& submission, std::string id, std::string_view build) {
  StoredJob stored;
  stored.job.id = std::move(id);
  stored.job.created = api::now();
  stored.job.options = submission.options;
  stored.job.input = {submission.model.sha256, submission.model.bytes, std::nullopt};
  stored.inputs.push_back({"model", submission.model.bytes});
  for (const api::Part& part : submission.files) stored.inputs.push_back({part.file_name, part.bytes});
  stored.idempotency_key = submission.idempotency_key;
  stored.fingerprint = sha256_of(api::dump(contents_of(submission)));
  stored.cache_key = cache_key(submission, build);
  return stored;
}

std::string_view name_of(api::JobFile kind) { return result_names.at(static_cast<std::size_t>(kind)); }

std::string output_of_map(std::string_view map) { return std::string(map_prefix) + std::string(map); }

std::optional<std::string> map_of_output(std::string_view name) {
  if (!name.starts_with(map_prefix)) return std::nullopt;
  name.remove_prefix(map_prefix.size());
  const bool safe = name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-.") == std::string_view::npos &&
                    !name.starts_with('.') && std::ranges::count(name, '.') == 1;
  return safe ? std::optional<std::string>(name) : std::nullopt;
}

bool is_result(std::string_view name) {
  return std::ranges::find(result_names, name) != result_names.end() || map_of_output(name).has_value();
}

void take_results(StoredJob& stored, const JobOutcome& outcome, const std::filesystem::path& report) {
  for (const std::string_view name : result_names) {
    const auto file = std::ranges::find(outcome.files, name, &OutputFile::name);
    if (file == outcome.files.end()) throw Error(ErrorCode::internal, "a result of the job is missing");
    stored.outputs.emplace_back(name, api::JobResult{file->sha256, file->bytes});
  }
  for (const OutputFile& file : outcome.files) {
    const auto map = map_of_output(file.name);
    if (!map) continue;
    stored.outputs.emplace_back(file.name, api::JobResult{file.sha256, file.bytes});
    stored.job.maps.push_back(*map);
  }
  try {
    const Json json = Json::parse(read_file(report, max_report_bytes));
    stored.job.timing.stages = api::timing_from_json(json.at("timing")).stages;
    stored.job.input.triangles = json.at("input").at("triangles").get<std::uint64_t>();
    json.at("partial").get_to(stored.job.partial);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::internal, "the job's report is unreadable");
  }
  stored.job.result = stored.outputs.front().second;
}

} // namespace orbis::server
