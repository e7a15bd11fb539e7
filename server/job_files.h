// What a job takes in and leaves behind.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/job_runner.h"
#include "server/job_store.h"

namespace orbis::server {

// The job that a submission asks for, queued, with a fingerprint that two requests for the same share, and the cache
// key that `build` (what tells one program from another) completes.
[[nodiscard]] StoredJob new_job(const api::Submission& submission, std::string id, std::string_view build);

// The name under which a result is stored: "result.glb", "report.json", "atlas.png", "preview.png".
[[nodiscard]] std::string_view name_of(api::JobFile kind);
// The name under which a map is stored: "map-normal.png" for "normal.png".
[[nodiscard]] std::string output_of_map(std::string_view map);
// The other way round: nothing where the name is not a map's. Maps' names are made of lower-case letters, digits, _, -
// and one dot, so that none leads out of a directory.
[[nodiscard]] std::optional<std::string> map_of_output(std::string_view name);
[[nodiscard]] bool is_result(std::string_view name);

// Enters the files of a job that has succeeded, and what its report says about its input and its stages.
// Throws Error{internal} where a result is missing or the report is unreadable.
void take_results(StoredJob& stored, const JobOutcome& outcome, const std::filesystem::path& report);

} // namespace orbis::server
