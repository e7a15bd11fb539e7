#include "server/job_log.h"

#include "api/json.h"
#include "server/log.h"

namespace orbis::server {

void log_job(std::string_view event, const api::Job& job) {
  api::Json fields{{"job", job.id}, {"state", name_of(job.state)}, {"attempt", job.attempt}};
  if (job.timing.wall_ms) fields["wall_ms"] = *job.timing.wall_ms;
  if (job.timing.cpu_ms) fields["cpu_ms"] = *job.timing.cpu_ms;
  if (job.problem) fields["problem"] = {{"type", job.problem->slug}, {"detail", job.problem->detail}};
  log_event(Level::info, event, fields);
}

} // namespace orbis::server
