#include "server/config.h"

#include <algorithm>
#include <charconv>
#include <fstream>

#include "api/json.h"

namespace orbis::server {
namespace {

// Thrown by a row's `set` for a text that it does not take; set() adds the name.
struct BadValue {};

std::uint64_t number(std::string_view text, std::uint64_t low, std::uint64_t high) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < low || value > high) throw BadValue{};
  return value;
}

// A number of bytes, with an optional K, M or G (powers of 1024).
std::uint64_t byte_count(std::string_view text) {
  constexpr std::string_view units = "KMG";
  unsigned shift = 0;
  if (!text.empty()) {
    if (const auto unit = units.find(text.back()); unit != std::string_view::npos) {
      shift = 10 * (static_cast<unsigned>(unit) + 1);
      text.remove_suffix(1);
    }
  }
  return number(text, 1, (1ull << 50) >> shift) << shift;
}

bool on_or_off(std::string_view text) {
  if (text != "on" && text != "off") throw BadValue{};
  return text == "on";
}

std::vector<std::string> list(std::string_view text) {
  std::vector<std::string> items;
  while (!text.empty()) {
    const auto end = std::min(text.find(','), text.size());
    if (end > 0) items.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return items;
}

#define ORBIS_NUMBER(member, low, high)                                                                                \
  [](Config& c, std::string_view t) {                                                                                  \
    (member) = static_cast<std::remove_reference_t<decltype(member)>>(number(t, low, high));                           \
  },                                                                                                                   \
      [](const Config& c) { return std::to_string(member); }
#define ORBIS_BYTES(member)                                                                                            \
  [](Config& c, std::string_view t) { (member) = byte_count(t); },                                                     \
      [](const Config& c) { return std::to_string(member); }
#define ORBIS_SECONDS(member, low, high)                                                                               \
  [](Config& c, std::string_view t) { (member) = std::chrono::seconds(number(t, low, high)); },                        \
      [](const Config& c) { return std::to_string((member).count()); }

constexpr std::uint64_t billion = 1'000'000'000;

constexpr Setting table[] = {
    {"host", "address", "where to listen; 0.0.0.0 for every interface",
     [](Config& c, std::string_view t) { c.http.host = t; }, [](const Config& c) { return c.http.host; }},
    {"port", "0 to 65535", "where to listen; 0 for any free port", ORBIS_NUMBER(c.http.port, 0, 65535)},
    {"data", "directory", "where jobs, uploads and results lie", [](Config& c, std::string_view t) { c.data = t; },
     [](const Config& c) { return c.data.string(); }},
    {"workers", "1 to 256", "jobs that run at a time", ORBIS_NUMBER(c.scheduler.workers, 1, 256)},
    {"queue", "1 to 100000", "jobs that may wait; more are answered with 429",
     ORBIS_NUMBER(c.scheduler.queue, 1, 100'000)},
    {"connections", "16 to 10000", "connections at a time", ORBIS_NUMBER(c.http.connections, 16, 10'000)},
    {"max_bytes", "bytes (K, M, G)", "largest body of a request",
     [](Config& c, std::string_view t) { c.http.max_bytes = c.scheduler.limits.content.max_bytes = byte_count(t); },
     [](const Config& c) { return std::to_string(c.http.max_bytes); }},
    {"max_triangles", "number", "most triangles of a model",
     ORBIS_NUMBER(c.scheduler.limits.content.max_triangles, 1, billion)},
    {"max_vertices", "number", "most vertices of a model",
     ORBIS_NUMBER(c.scheduler.limits.content.max_vertices, 1, billion)},
    {"max_image_pixels", "number", "most pixels of an image",
     ORBIS_NUMBER(c.scheduler.limits.content.max_image_pixels, 1, billion)},
    {"job_seconds", "1 to 86400", "wall time of a job; its processor time is this for each core",
     ORBIS_NUMBER(c.scheduler.limits.seconds, 1, 86'400)},
    {"job_memory", "bytes (K, M, G)", "address space of a job", ORBIS_BYTES(c.scheduler.limits.memory_bytes)},
    {"job_output", "bytes (K, M, G)", "size of a job's results", ORBIS_BYTES(c.scheduler.limits.output_bytes)},
    {"checkpoint_every", "seconds",
     "at least so long from one checkpoint of a job to the next; after a restart it goes on from the last",
     ORBIS_NUMBER(c.scheduler.limits.checkpoint_seconds, 0, 86'400)},
    {"ttl", "seconds", "how long results are kept", ORBIS_SECONDS(c.scheduler.time_to_live, 1, billion)},
    {"cache", "on | off", "whether a request that was answered before is answered with that result, while it is kept",
     [](Config& c, std::string_view t) { c.scheduler.cache = on_or_off(t); },
     [](const Config& c) { return std::string(c.scheduler.cache ? "on" : "off"); }},
    {"drain", "seconds", "time that running jobs get when the service stops", ORBIS_SECONDS(c.drain, 0, 86'400)},
    {"keys", "key,key,…", "bearer keys that are accepted; none: no key is asked for",
     [](Config& c, std::string_view t) { c.keys = list(t); },
     [](const Config& c) { return std::string(c.keys.empty() ? "" : "(set)"); }},
};

#undef ORBIS_NUMBER
#undef ORBIS_BYTES
#undef ORBIS_SECONDS

std::string spelled(std::string_view setting, char separator, char (*letter)(char)) {
  std::string name;
  for (const char c : setting) name += c == '_' ? separator : letter(c);
  return name;
}

} // namespace

std::span<const Setting> settings() { return table; }

void set(Config& config, std::string_view name, std::string_view text) {
  const auto* row = std::ranges::find(table, name, &Setting::name);
  if (row == std::end(table)) {
    throw Error(ErrorCode::invalid_option, "there is no setting '" + std::string(name) + "'", std::string(name));
  }
  try {
    row->set(config, text);
  } catch (const BadValue&) {
    throw Error(ErrorCode::invalid_option,
                "the setting '" + std::string(name) + "' cannot be '" + std::string(text) + "': it takes " +
                    std::string(row->value),
                std::string(name));
  }
}

void apply_file(Config& config, const std::filesystem::path& file) {
  std::ifstream in(file);
  const api::Json json = api::Json::parse(in, nullptr, false);
  if (!json.is_object()) {
    throw Error(ErrorCode::invalid_option,
                "the configuration file '" + file.string() + "' is not a JSON object of settings");
  }
  for (const auto& [name, value] : json.items()) {
    set(config, name, value.is_string() ? value.get<std::string>() : value.dump());
  }
}

void apply_environment(Config& config, const Environment& environment) {
  for (const Setting& setting : table) {
    if (const auto value = environment(environment_name(setting.name))) set(config, setting.name, *value);
  }
}

std::string environment_name(std::string_view setting) {
  return "ORBIS_" +
         spelled(setting, '_', [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
}

std::string flag_name(std::string_view setting) {
  return "--" + spelled(setting, '-', [](char c) { return c; });
}

} // namespace orbis::server
