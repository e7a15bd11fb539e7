// What happens to jobs, in the log.
#pragma once

#include <string_view>

#include "api/job_service.h"

namespace orbis::server {

// One event of a job's life: "job_queued", "job_started", "job_ended", …
void log_job(std::string_view event, const api::Job& job);

} // namespace orbis::server
