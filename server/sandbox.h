// What the process of one job may do: compute, and talk through the pipes it has.
#pragma once

#include "server/job_runner.h"

namespace orbis::server {

// True where the build has a sanitizer, whose runtime needs more than the sandbox allows: such a build is for tests of
// the code, and runs its jobs without memory limit and system call filter.
extern const bool sanitized_build;

// First thing in the child: closes inherited files and asks to be killed when the parent goes.
void detach_from_parent();

// Limits of address space, CPU time, file size (none can be written), core dumps, and the niceness.
void apply_resource_limits(const JobLimits& limits);

// From here on only the system calls of computing threads work; opening, connecting, executing fail with EPERM.
// Cannot be undone. Throws Error{internal} where the kernel refuses: a job is never run without it.
void enter_sandbox();

} // namespace orbis::server
