// The parent's side of a job's process, with shell scripts as its children: what they may do to us, and what comes of
// it.
#include <doctest/doctest.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/worker_process.h"
#include "support/temporary_directory.h"

using namespace orbis;
using server::JobOutcome;

namespace {

struct Parent {
  test::TemporaryDirectory directory;
  server::JobTask task;
  std::stop_source stop;
  std::vector<std::pair<Stage, std::uint64_t>> reports;
  std::function<void()> on_progress = [] {};

  Parent() {
    std::signal(SIGPIPE, SIG_IGN);
    task.limits.seconds = 60;
    set_model("glTF");
  }
  void set_model(const std::string& contents) {
    std::ofstream(directory.path / "model", std::ios::binary) << contents;
    task.model = {"model", directory.path / "model", contents.size()};
  }
  JobOutcome run(const std::string& script) {
    server::WorkerProcess process({"/bin/sh", "-c", script});
    const server::JobHooks hooks{[&](Stage stage, std::uint64_t done, std::uint64_t) {
                                   reports.emplace_back(stage, done);
                                   on_progress();
                                 },
                                 [&](std::string_view name) { return directory.path / name; }};
    return process.run(task, hooks, stop.get_token());
  }
  std::string contents(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(directory.path / name).rdbuf();
    return text.str();
  }
};

ErrorCode error_of(const JobOutcome& outcome) {
  REQUIRE(outcome.error.has_value());
  return outcome.error->code();
}

const std::string done = R"(echo '{"done":true}')";

} // namespace

TEST_CASE_FIXTURE(Parent, "a child's progress, files and end arrive") {
  const JobOutcome outcome = run(R"(echo '{"progress":{"stage":"refine","done":3,"total":9}}'
    echo '{"file":{"name":"a.bin","bytes":5}}'; printf 'x{\n}y'
    echo '{"file":{"name":"empty","bytes":0}}'; )" +
                                 done);
  CHECK_FALSE(outcome.error.has_value());
  CHECK(reports == decltype(reports){{Stage::refine, 3}});
  REQUIRE(outcome.files.size() == 2);
  CHECK(contents("a.bin") == "x{\n}y");
  CHECK(outcome.files[0].bytes == 5);
  CHECK(outcome.files[1].sha256 == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(outcome.peak_rss_bytes > 0);
}

TEST_CASE_FIXTURE(Parent,
                  "of a child's checkpoints the last one stays, and they may add up to more than a job's output") {
  task.limits.output_bytes = 8;
  const JobOutcome outcome = run(R"(echo '{"file":{"name":"checkpoint","bytes":5}}'; printf 'early'
    echo '{"file":{"name":"checkpoint","bytes":4}}'; printf 'late'
    echo '{"file":{"name":"a.bin","bytes":8}}'; printf '12345678'; )" +
                                 done);
  CHECK_FALSE(outcome.error.has_value());
  CHECK(contents("checkpoint") == "late");
  REQUIRE(outcome.files.size() == 2);
  CHECK(outcome.files[0].bytes == 4);
}

TEST_CASE_FIXTURE(Parent, "a checkpoint comes to the child behind the files") {
  std::ofstream(directory.path / "half") << "half way";
  task.checkpoint = server::InputFile{"checkpoint", directory.path / "half", 8};
  const JobOutcome outcome = run("read -r line; printf '%s' \"$line\" >" + (directory.path / "line").string() +
                                 "; head -c 12 >" + (directory.path / "rest").string() + "; " + done);
  CHECK_FALSE(outcome.error.has_value());
  CHECK(contents("rest") == "glTFhalf way");
  CHECK(contents("line").find(R"("checkpoint":{"name":"checkpoint","bytes":8})") != std::string::npos);
}

TEST_CASE_FIXTURE(Parent, "the child gets the task's line and the bytes of all files, however long") {
  const std::string big(3 << 20, 'm');
  set_model(big);
  std::ofstream(directory.path / "second") << "second";
  task.files.push_back({"textures/second.bin", directory.path / "second", 6});
  // It reads as much as the line announces and says what it got.
  const JobOutcome outcome =
      run("read -r line; printf '%s' \"$line\" >" + (directory.path / "line").string() + "; head -c " +
          std::to_string(big.size() + 6) + " >" + (directory.path / "rest").string() + "; " + done);
  CHECK_FALSE(outcome.error.has_value());
  CHECK(contents("line").find(R"({"name":"textures/second.bin","bytes":6})") != std::string::npos);
  CHECK(contents("rest") == big + "second");
}

TEST_CASE_FIXTURE(Parent, "an error that the child names is the job's") {
  const JobOutcome outcome =
      run(R"(echo '{"error":{"code":"not-genus-zero","message":"a torus","where":"/meshes/0"}}')");
  CHECK(error_of(outcome) == ErrorCode::not_genus_zero);
  CHECK(outcome.error->message() == "a torus");
  CHECK(outcome.error->where() == "/meshes/0");
}

TEST_CASE_FIXTURE(Parent, "a crash is an internal error, a kill means memory, SIGXCPU means time") {
  CHECK(error_of(run("kill -SEGV $$")) == ErrorCode::internal);
  CHECK(error_of(run("kill -ABRT $$")) == ErrorCode::internal);
  CHECK(error_of(run("exit 3")) == ErrorCode::internal);
  CHECK(error_of(run("kill -KILL $$")) == ErrorCode::out_of_memory);
  CHECK(error_of(run("kill -XCPU $$")) == ErrorCode::out_of_time);
}

TEST_CASE_FIXTURE(Parent, "a child that stops half way through a file has not succeeded, and leaves none") {
  const JobOutcome outcome = run(R"(echo '{"file":{"name":"cut.bin","bytes":100}}'; printf 'short')");
  CHECK(error_of(outcome) == ErrorCode::internal);
  CHECK(outcome.files.empty());
  CHECK_FALSE(std::filesystem::exists(directory.path / "cut.bin"));
}

TEST_CASE_FIXTURE(Parent, "a child that talks nonsense is not believed") {
  for (const char* message :
       {"echo hello", "echo '[]'", "echo '{}'", "echo '{\"progress\":{\"stage\":\"sleep\",\"done\":1,\"total\":1}}'",
        "echo '{\"progress\":{\"stage\":\"refine\",\"done\":\"x\",\"total\":1}}'",
        "echo '{\"file\":{\"name\":\"../escape\",\"bytes\":1}}'",
        "echo '{\"file\":{\"name\":\".hidden\",\"bytes\":1}}'", "echo '{\"file\":{\"name\":\"a\",\"bytes\":-1}}'",
        "echo '{\"error\":{\"code\":\"queue-full\",\"message\":\"\",\"where\":\"\"}}'",
        "head -c 200000 /dev/zero | tr '\\0' x"}) {
    CAPTURE(message);
    CHECK(error_of(run(std::string(message) + "; exec sleep 1000")) == ErrorCode::internal);
  }
}

TEST_CASE_FIXTURE(Parent, "results may not be larger than the operator allows") {
  task.limits.output_bytes = 10;
  CHECK(error_of(run(R"(echo '{"file":{"name":"big","bytes":11}}'; exec sleep 1000)")) == ErrorCode::too_large);
}

TEST_CASE_FIXTURE(Parent, "a stop request ends a child that obeys, and one that does not") {
  for (const char* script : {"", "trap '' TERM; "}) {
    stop = {};
    on_progress = [&] { stop.request_stop(); };
    const std::string working = R"(echo '{"progress":{"stage":"refine","done":1,"total":2}}'; while :; do :; done)";
    CHECK(error_of(run(script + working)) == ErrorCode::canceled);
  }
}

TEST_CASE_FIXTURE(Parent, "a child that takes longer than it may is stopped") {
  task.limits.seconds = 1;
  const JobOutcome outcome = run("while :; do :; done");
  CHECK(error_of(outcome) == ErrorCode::out_of_time);
  CHECK(outcome.error->message().find("1 seconds") != std::string::npos);
}

TEST_CASE_FIXTURE(Parent, "a child that does not read its input is no trouble") {
  set_model(std::string(1 << 20, 'm'));
  CHECK_FALSE(run("exec 0<&-; " + done).error.has_value());
}

TEST_CASE_FIXTURE(Parent, "a program that cannot be started is an internal error") {
  server::WorkerProcess process({"/nonexistent/program"});
  CHECK_THROWS_AS((void)process.run(task, {[](Stage, auto, auto) {}, [](auto) { return ""; }}, {}), Error);
}
