// Server-Sent Events of one job.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "api/http.h"
#include "api/job_service.h"

namespace orbis::api {

// The events that lead from `before` to `after`: stage, progress, state, whichever applies. The last one has after's
// version as its id: whoever saw only some of them gets all of them again. With no `before` all that is true now.
[[nodiscard]] std::string events_between(const Job* before, const Job& after);

// A stream of a job's events from its version `last_seen` on, which ends after the event of its final state.
// `slot` is kept as long as the stream lives.
[[nodiscard]] StreamBody event_stream(JobService& jobs, std::string id, std::uint64_t last_seen,
                                      std::chrono::seconds comment_every, std::shared_ptr<void> slot);

} // namespace orbis::api
