// What a job's process can still do once it is in its sandbox. Each check runs in a process of its own, which cannot
// leave the sandbox again.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <functional>
#include <new>
#include <thread>
#include <vector>

#include "server/sandbox.h"

using namespace orbis;

namespace {

// The exit status of a process that enters the sandbox and then does this; -1 where a signal ended it.
int in_sandbox(const std::function<int()>& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    server::enter_sandbox();
    ::_exit(action());
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool skipped() {
  if (server::sanitized_build) MESSAGE("skipped: a build with sanitizers has no sandbox");
  return server::sanitized_build;
}

} // namespace

TEST_CASE("in the sandbox no file can be opened, no socket, no process started") {
  if (skipped()) return;
  CHECK(in_sandbox([] { return ::open("/etc/passwd", O_RDONLY) < 0 && errno == EPERM ? 0 : 1; }) == 0);
  CHECK(in_sandbox([] { return ::open("/tmp/orbis-sandbox", O_WRONLY | O_CREAT, 0600) < 0 ? 0 : 1; }) == 0);
  CHECK(in_sandbox([] { return ::socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM ? 0 : 1; }) == 0);
  CHECK(in_sandbox([] { return ::fork() < 0 ? 0 : 1; }) == 0);
  CHECK(in_sandbox([] {
          ::execl("/bin/true", "true", nullptr);
          return errno == EPERM ? 0 : 1;
        }) == 0);
  CHECK(in_sandbox([] { return ::kill(::getppid(), 0) < 0 ? 0 : 1; }) == 0);
}

TEST_CASE("in the sandbox threads and memory work") {
  if (skipped()) return;
  CHECK(in_sandbox([] {
          std::vector<std::thread> threads;
          std::atomic<std::size_t> sum{0};
          for (std::size_t i = 1; i <= 8; ++i) {
            threads.emplace_back([&sum, i] { sum += std::vector<char>(i << 20, 1).size() >> 20; });
          }
          for (std::thread& thread : threads) thread.join();
          return sum == 36 && std::thread::hardware_concurrency() > 0 ? 0 : 1;
        }) == 0);
}

TEST_CASE("a job's memory is limited") {
  if (skipped()) return;
  const pid_t child = ::fork();
  if (child == 0) {
    server::JobLimits limits;
    limits.memory_bytes = 512u << 20;
    server::apply_resource_limits(limits);
    try {
      const std::vector<char> large(std::size_t{1} << 30, 'x');
      ::_exit(large[42] == 'x' ? 1 : 2);
    } catch (const std::bad_alloc&) {
      ::_exit(0);
    }
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(status == 0);
}
