// The process of one job: reads a task and its files, enters the sandbox, runs the pipeline, sends the results.
#pragma once

namespace orbis::server {

// Talks over standard input and output as server/job_messages.h says. Does not return.
[[noreturn]] void run_job_child();

} // namespace orbis::server
