#include "server/sandbox.h"

#include <linux/close_range.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <memory>
#include <thread>

namespace orbis::server {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
const bool sanitized_build = true;
#else
const bool sanitized_build = false;
#endif

namespace {

void limit(int resource, rlim_t soft, rlim_t hard) {
  const rlimit value{soft, hard};
  if (::setrlimit(static_cast<__rlimit_resource>(resource), &value) != 0) {
    throw Error(ErrorCode::internal, "the job's limits could not be set");
  }
}

void require(int result) {
  if (result < 0) throw Error(ErrorCode::internal, "the job's sandbox could not be set up");
}

// Memory, threads, clocks, signals to itself, and the pipes. Everything else is refused.
constexpr int allowed_calls[] = {
    SCMP_SYS(read),
    SCMP_SYS(write),
    SCMP_SYS(writev),
    SCMP_SYS(close),
    SCMP_SYS(fstat),
    SCMP_SYS(newfstatat),
    SCMP_SYS(lseek),
    SCMP_SYS(mmap),
    SCMP_SYS(munmap),
    SCMP_SYS(mprotect),
    SCMP_SYS(mremap),
    SCMP_SYS(madvise),
    SCMP_SYS(brk),
    SCMP_SYS(futex),
    SCMP_SYS(set_robust_list),
    SCMP_SYS(rseq),
    SCMP_SYS(set_tid_address),
    SCMP_SYS(exit),
    SCMP_SYS(exit_group),
    SCMP_SYS(sched_yield),
    SCMP_SYS(sched_getaffinity),
    SCMP_SYS(gettid),
    SCMP_SYS(getpid),
    SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),
    SCMP_SYS(sigaltstack),
    SCMP_SYS(clock_gettime),
    SCMP_SYS(clock_getres),
    SCMP_SYS(clock_nanosleep),
    SCMP_SYS(nanosleep),
    SCMP_SYS(gettimeofday),
    SCMP_SYS(getrusage),
    SCMP_SYS(getrandom),
    SCMP_SYS(sysinfo),
    SCMP_SYS(restart_syscall),
    SCMP_SYS(membarrier),
};

} // namespace

void detach_from_parent() {
  const pid_t parent = ::getppid();
  ::syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1); // it went before we asked
}

void apply_resource_limits(const JobLimits& limits) {
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  if (!sanitized_build) limit(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
  const rlim_t cores = std::max(1U, std::thread::hardware_concurrency());
  const rlim_t cpu_seconds = limits.seconds * cores + 1; // the wall clock is the parent's to watch
  limit(RLIMIT_CPU, cpu_seconds, cpu_seconds + 1);
  ::prctl(PR_SET_DUMPABLE, 0);
  errno = 0;
  if (::nice(limits.niceness) == -1 && errno != 0)
    throw Error(ErrorCode::internal, "the job's niceness could not be set");
}

void enter_sandbox() {
  if (sanitized_build) return;
  const std::unique_ptr<void, decltype(&seccomp_release)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)), &seccomp_release);
  if (!filter) throw Error(ErrorCode::internal, "the job's sandbox could not be set up");
  for (const int call : allowed_calls) require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, call, 0));
  // Threads, but no processes. The flags of clone3 lie in memory where a filter cannot look: the C library falls back
  // to clone when clone3 does not exist.
  require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                           SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD)));
  require(seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0));
  // abort() signals its own thread.
  require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
                           SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(::getpid()))));
  // Thread stacks take their size from the limits, which may be read but not set.
  require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), 1, SCMP_A2(SCMP_CMP_EQ, 0)));
  require(seccomp_load(filter.get()));
}

} // namespace orbis::server
