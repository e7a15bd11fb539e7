// The operator's settings: defaults < configuration file < environment < command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/http_server.h"
#include "server/scheduler.h"

namespace orbis::server {

struct Config {
  HttpSettings http;
  SchedulerSettings scheduler;
  std::filesystem::path data = "orbis-data";
  std::chrono::seconds drain{20};
  std::vector<std::string> keys;
};

// One row per setting. Its name is the same everywhere: "max_bytes" in the file, ORBIS_MAX_BYTES in the environment,
// --max-bytes on the command line.
struct Setting {
  std::string_view name, value, summary; // value: what it takes, for people
  void (*set)(Config& config, std::string_view text);
  std::string (*get)(const Config& config);
};
[[nodiscard]] std::span<const Setting> settings();

// Sets one. Throws Error{invalid_option} that names the setting and what it takes.
void set(Config& config, std::string_view name, std::string_view text);

using Environment = std::function<std::optional<std::string>(const std::string& name)>;

// Applies a JSON file of settings ({"port": 8080}), then the environment. Throws Error{invalid_option}.
void apply_file(Config& config, const std::filesystem::path& file);
void apply_environment(Config& config, const Environment& environment);

[[nodiscard]] std::string environment_name(std::string_view setting); // "ORBIS_MAX_BYTES"
[[nodiscard]] std::string flag_name(std::string_view setting);        // "--max-bytes"

} // namespace orbis::server
