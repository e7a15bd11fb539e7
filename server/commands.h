// The subcommands of `orbis`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/options.h"
#include "server/config.h"

namespace orbis::server {

// `orbis serve`: until SIGTERM or SIGINT, which drain; a second one ends at once. Returns the exit status.
[[nodiscard]] int serve(const Config& config);

struct RunArguments {
  std::filesystem::path input, output;
  std::optional<std::filesystem::path> report, preview, dump_stages, save_maps; // two files, two directories
  std::vector<std::filesystem::path> attachments;                               // files, or directories of files
  std::optional<std::filesystem::path> second;                                  // of `orbis morph`: the other model
  std::vector<std::pair<std::string, std::string>> options;                     // by name, as set_option takes them
};

// `orbis run`, `orbis morph`: one job without a server, in a child process all the same. Returns the exit status: 0
// with a result, 2 where the input was refused (the problem document is on standard error), 1 on anything else.
[[nodiscard]] int run(const RunArguments& arguments, const JobLimits& limits);

} // namespace orbis::server
