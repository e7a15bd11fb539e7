#include "server/job_messages.h"

#include <algorithm>

#include "api/json.h"
#include "api/problem.h"
#include "core/utf8.h"

namespace orbis::server {
namespace {

using api::Json;

// No message is longer, but for the bytes of files.
constexpr std::size_t max_line = 64 << 10;
constexpr std::size_t longest_text = 8000; // stays below max_line even where every byte is escaped

[[noreturn]] void broken() { throw Error(ErrorCode::internal, "the job's process sent something unreadable"); }

Json file_json(const InputFile& file) { return {{"name", as_utf8(file.name)}, {"bytes", file.bytes}}; }

InputFile input_file(const Json& json) {
  return {json.at("name").get<std::string>(), {}, json.at("bytes").get<std::uint64_t>()};
}

Json limits_json(const JobLimits& limits) {
  return {{"max_bytes", limits.content.max_bytes},
          {"max_triangles", limits.content.max_triangles},
          {"max_vertices", limits.content.max_vertices},
          {"max_image_pixels", limits.content.max_image_pixels},
          {"max_json_depth", limits.content.max_json_depth},
          {"memory_bytes", limits.memory_bytes},
          {"output_bytes", limits.output_bytes},
          {"seconds", limits.seconds},
          {"niceness", limits.niceness},
          {"checkpoint_seconds", limits.checkpoint_seconds}};
}

JobLimits limits_from(const Json& json) {
  JobLimits limits;
  json.at("max_bytes").get_to(limits.content.max_bytes);
  json.at("max_triangles").get_to(limits.content.max_triangles);
  json.at("max_vertices").get_to(limits.content.max_vertices);
  json.at("max_image_pixels").get_to(limits.content.max_image_pixels);
  json.at("max_json_depth").get_to(limits.content.max_json_depth);
  json.at("memory_bytes").get_to(limits.memory_bytes);
  json.at("output_bytes").get_to(limits.output_bytes);
  json.at("seconds").get_to(limits.seconds);
  json.at("niceness").get_to(limits.niceness);
  json.at("checkpoint_seconds").get_to(limits.checkpoint_seconds);
  return limits;
}

Stage stage_of(std::string_view name) {
  const auto* it = std::ranges::find(stage_names, name);
  if (it == stage_names.end()) broken();
  return static_cast<Stage>(it - stage_names.begin());
}

// A file name that stays in its directory.
std::string checked_name(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_';
  };
  if (name.empty() || name.size() > 100 || name.front() == '.' || !std::ranges::all_of(name, plain)) broken();
  return name;
}

std::uint64_t count_from(const Json& json) {
  if (!json.is_number_unsigned()) broken();
  return json.get<std::uint64_t>();
}

Error error_from(const Json& json) {
  const auto code = api::error_code(json.at("code").get<std::string>());
  if (!code) broken();
  return {*code, json.at("message").get<std::string>(), json.at("where").get<std::string>()};
}

} // namespace

std::string task_line(const JobTask& task) {
  Json files = Json::array();
  for (const InputFile& file : task.files) files.push_back(file_json(file));
  return api::dump({{"model", file_json(task.model)},
                    {"files", std::move(files)},
                    {"checkpoint", task.checkpoint ? file_json(*task.checkpoint) : Json()},
                    {"options", api::to_json(task.options)},
                    {"limits", limits_json(task.limits)},
                    {"dump_stages", task.dump_stages}}) +
         "\n";
}

JobTask parse_task(std::string_view line) {
  try {
    const Json json = Json::parse(line);
    JobTask task;
    task.model = input_file(json.at("model"));
    for (const Json& file : json.at("files")) task.files.push_back(input_file(file));
    if (const Json& checkpoint = json.at("checkpoint"); !checkpoint.is_null()) task.checkpoint = input_file(checkpoint);
    task.options = api::options_from_json(json.at("options"));
    task.limits = limits_from(json.at("limits"));
    json.at("dump_stages").get_to(task.dump_stages);
    return task;
  } catch (const Json::exception&) {
    throw Error(ErrorCode::internal, "the job's task is unreadable");
  }
}

std::string progress_line(Stage stage, std::uint64_t done, std::uint64_t total) {
  return api::dump({{"progress", {{"stage", name_of(stage)}, {"done", done}, {"total", total}}}}) + "\n";
}

std::string file_line(std::string_view name, std::uint64_t bytes) {
  return api::dump({{"file", {{"name", name}, {"bytes", bytes}}}}) + "\n";
}

std::string error_line(const Error& error) {
  return api::dump({{"error",
                     {{"code", api::problem_type(error.code()).slug},
                      {"message", error.message().substr(0, longest_text)},
                      {"where", error.where().substr(0, 1000)}}}}) +
         "\n";
}

std::string log_line(std::string_view text) { return api::dump({{"log", text.substr(0, longest_text)}}) + "\n"; }

std::string done_line() { return "{\"done\":true}\n"; }

void MessageParser::feed(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (file_left_ > 0) {
      const auto piece = bytes.first(static_cast<std::size_t>(std::min<std::uint64_t>(file_left_, bytes.size())));
      handler_.file_bytes(piece);
      file_left_ -= piece.size();
      bytes = bytes.subspan(piece.size());
      if (file_left_ == 0) handler_.file_ends();
      continue;
    }
    const auto newline = std::ranges::find(bytes, std::byte{'\n'});
    const auto length = static_cast<std::size_t>(newline - bytes.begin());
    if (line_.size() + length > max_line) broken();
    line_.append(reinterpret_cast<const char*>(bytes.data()), length);
    if (newline == bytes.end()) return;
    bytes = bytes.subspan(length + 1);
    take_line();
  }
}

void MessageParser::take_line() {
  const Json json = Json::parse(std::exchange(line_, {}), nullptr, false);
  try {
    if (json.contains("progress")) {
      const Json& p = json["progress"];
      handler_.progress(stage_of(p.at("stage").get<std::string>()), count_from(p.at("done")),
                        count_from(p.at("total")));
    } else if (json.contains("file")) {
      file_left_ = count_from(json["file"].at("bytes"));
      handler_.file_begins(checked_name(json["file"].at("name").get<std::string>()), file_left_);
      if (file_left_ == 0) handler_.file_ends();
    } else if (json.contains("error")) {
      handler_.error(error_from(json["error"]));
    } else if (json.contains("log")) {
      handler_.log(json["log"].get<std::string>());
    } else if (json.contains("done")) {
      handler_.done();
    } else {
      broken();
    }
  } catch (const Json::exception&) {
    broken();
  }
}

} // namespace orbis::server
