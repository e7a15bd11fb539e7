// C++ values to the JSON of the contract, and back where a value is stored.
#pragma once

#include <nlohmann/json.hpp>

#include "api/job.h"
#include "api/job_service.h"
#include "core/report.h"

namespace orbis::api {

// Keeps the order in which the contract shows the members.
using Json = nlohmann::ordered_json;

[[nodiscard]] Json to_json(const Job& job);
[[nodiscard]] Json to_json(const JobPage& page);
[[nodiscard]] Json to_json(const Problem& problem);
[[nodiscard]] Json to_json(const Timing& timing);
[[nodiscard]] Json to_json(const Options& options);
[[nodiscard]] Json to_json(const JobProgress& progress);
[[nodiscard]] Json to_json(const Report& report);

// The inverse of to_json. Throws nlohmann::json::exception or Error{invalid_option} for JSON that to_json has not made.
[[nodiscard]] Problem problem_from_json(const Json& json);
[[nodiscard]] Timing timing_from_json(const Json& json);
[[nodiscard]] Options options_from_json(const Json& json);
[[nodiscard]] JobProgress progress_from_json(const Json& json); // without the time to go

// RFC 3339 in UTC with milliseconds: "2026-01-31T12:00:00.000Z".
[[nodiscard]] std::string rfc3339(Time time);

// JSON text in UTF-8; bytes that are not UTF-8 (a client's file name in a message) become U+FFFD.
[[nodiscard]] std::string dump(const Json& json, int indent = -1);

} // namespace orbis::api
