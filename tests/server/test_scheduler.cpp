#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "server/fake_runner.h"
#include "server/job_files.h"
#include "server/scheduler.h"
#include "support/temporary_directory.h"

using namespace orbis;
using api::JobState;
using server::Scheduler;
using test::FakeRunner;

namespace {

// A service on a directory of its own. It can go down and come up again.
struct Service {
  test::TemporaryDirectory directory;
  FakeRunner runner;
  server::Metrics metrics;
  server::SchedulerSettings settings;
  std::unique_ptr<server::JobStore> store;
  std::unique_ptr<server::BlobStore> blobs;
  std::unique_ptr<Scheduler> scheduler;

  explicit Service(FakeRunner::Behaviour behaviour = FakeRunner::Behaviour::succeed) {
    runner.behaviour = behaviour;
    up();
  }
  void up() {
    store = std::make_unique<server::JobStore>(directory.path / "jobs.sqlite");
    blobs = std::make_unique<server::BlobStore>(directory.path);
    scheduler = std::make_unique<Scheduler>(*store, *blobs, runner, metrics, settings);
    scheduler->start();
  }
  void down() {
    scheduler->drain(std::chrono::milliseconds(0));
    scheduler.reset();
    blobs.reset();
    store.reset();
  }
  void restart() {
    down();
    up();
  }
  api::Job submit(const std::string& key = "", const std::string& contents = "glTF", const std::string& option = "",
                  const std::string& value = "") {
    api::Part part{"model", "", "", blobs->spool_path(), contents.size(), contents};
    std::ofstream(part.spooled) << contents;
    Options options;
    if (!option.empty()) set_option(options, option, value);
    return scheduler->submit({part, {}, options, key});
  }
  // Waits for the end of a job.
  api::Job finished(const std::string& id) {
    api::Job job = scheduler->find(id).value();
    while (!is_final(job.state)) job = scheduler->wait(id, job.version, std::chrono::seconds(60)).value();
    return job;
  }
};

int refusal_status(const std::function<void()>& action) {
  try {
    action();
  } catch (const api::Refused& refused) {
    return refused.problem().status;
  }
  return 0;
}

} // namespace

TEST_CASE("a job succeeds, with its files, times and triangles") {
  Service service;
  const api::Job job = service.finished(service.submit().id);
  CHECK(job.state == JobState::succeeded);
  CHECK(job.attempt == 1);
  CHECK(job.input.triangles == 12);
  CHECK(job.timing.cpu_ms == 20);
  CHECK(job.progress->percent == 100);
  CHECK(job.timing.stages.at(0).name == "refine");
  CHECK(job.started >= job.created);
  CHECK(job.finished >= job.started);
  CHECK(job.expires > job.finished);
  for (const auto kind : {api::JobFile::result, api::JobFile::report, api::JobFile::atlas, api::JobFile::preview}) {
    const auto file = service.scheduler->file(job.id, kind);
    REQUIRE(file.has_value());
    CHECK(std::filesystem::file_size(file->path) == file->bytes);
  }
  CHECK(job.maps == std::vector<std::string>{"normal.png"});
  CHECK(service.scheduler->map(job.id, "normal.png").has_value());
  CHECK_FALSE(service.scheduler->map(job.id, "other.png").has_value());
}

TEST_CASE("only names that stay in a job's directory are maps") {
  CHECK(server::map_of_output(server::output_of_map("normal-2.png")) == "normal-2.png");
  for (const char* name :
       {"normal.png", "map-../x.png", "map-a/b.png", "map-.png.", "map-", "map-N.png", "map-a.b.png"}) {
    CAPTURE(name);
    CHECK_FALSE(server::map_of_output(name).has_value());
  }
}

TEST_CASE("a job that fails keeps its problem") {
  Service service(FakeRunner::Behaviour::fail);
  const api::Job job = service.finished(service.submit().id);
  CHECK(job.state == JobState::failed);
  CHECK(job.problem->slug == "not-genus-zero");
  CHECK(job.problem->instance == "/v1/jobs/" + job.id);
  CHECK_FALSE(service.scheduler->file(job.id, api::JobFile::result).has_value());
}

TEST_CASE("a crash and a missing result fail that job only") {
  Service service(FakeRunner::Behaviour::crash);
  CHECK(service.finished(service.submit().id).problem->status == 500);
  service.runner.behaviour = FakeRunner::Behaviour::no_report;
  CHECK(service.finished(service.submit().id).problem->status == 500);
  service.runner.behaviour = FakeRunner::Behaviour::succeed;
  CHECK(service.finished(service.submit().id).state == JobState::succeeded);
}

TEST_CASE("the queue is bounded, and places are counted from 1") {
  Service service(FakeRunner::Behaviour::hang);
  service.settings.queue = 2;
  service.restart();
  const api::Job running = service.submit();
  service.runner.wait_started(1);
  CHECK(service.submit().queue_position == 1);
  CHECK(service.submit().queue_position == 2);
  CHECK_FALSE(service.scheduler->has_room(""));
  CHECK(refusal_status([&] { (void)service.submit(); }) == 429);
  CHECK(service.scheduler->find(running.id)->state == JobState::running);
}

TEST_CASE("a queued job is canceled at once and never starts") {
  Service service(FakeRunner::Behaviour::hang);
  (void)service.submit();
  service.runner.wait_started(1);
  const api::Job queued = service.submit();
  CHECK(service.scheduler->cancel(queued.id)->state == JobState::canceled);
  CHECK(service.scheduler->cancel(queued.id)->state == JobState::canceled);
  CHECK(service.scheduler->find(queued.id)->attempt == 0);
}

TEST_CASE("a running job is canceled, and its worker takes the next one") {
  Service service(FakeRunner::Behaviour::hang);
  const api::Job first = service.submit();
  service.runner.wait_started(1);
  CHECK(service.scheduler->cancel(first.id)->state == JobState::canceled);
  (void)service.submit();
  service.runner.wait_started(2);
  CHECK(service.scheduler->find(first.id)->state == JobState::canceled);
  CHECK_FALSE(service.scheduler->cancel("unknown").has_value());
}

TEST_CASE("jobs and results are there after a restart") {
  Service service;
  const api::Job before = service.finished(service.submit().id);
  service.restart();
  const api::Job after = service.scheduler->find(before.id).value();
  CHECK(after.state == JobState::succeeded);
  CHECK(after.result->sha256 == before.result->sha256);
  CHECK(std::filesystem::exists(service.scheduler->file(before.id, api::JobFile::result)->path));
}

TEST_CASE("what was queued or interrupted runs again after a restart") {
  Service service(FakeRunner::Behaviour::hang);
  const api::Job interrupted = service.submit();
  service.runner.wait_started(1);
  const api::Job queued = service.submit();
  service.down();
  service.runner.behaviour = FakeRunner::Behaviour::succeed;
  service.up();
  const api::Job first = service.finished(interrupted.id), second = service.finished(queued.id);
  CHECK(first.state == JobState::succeeded);
  CHECK(first.attempt == 2);
  CHECK(second.attempt == 1);
  CHECK(first.version > interrupted.version);
}

TEST_CASE("an interrupted job gets its checkpoint back from the same build, and none is left when it ends") {
  Service service(FakeRunner::Behaviour::keep_and_hang);
  service.down();
  service.settings.build = "0123456789abcdef-one";
  service.up();
  const std::string id = service.submit().id;
  service.runner.wait_started(1);
  CHECK_FALSE(service.runner.last_task.checkpoint.has_value());
  service.down();
  const std::filesystem::path kept = service.directory.path / "jobs" / id / "checkpoint-0123456789abcdef";
  REQUIRE(std::filesystem::exists(kept));

  service.runner.behaviour = FakeRunner::Behaviour::hang;
  service.up();
  service.runner.wait_started(2);
  REQUIRE(service.runner.last_task.checkpoint.has_value());
  CHECK(service.runner.last_task.checkpoint->path == kept);
  CHECK(service.runner.last_task.checkpoint->bytes == 8);
  service.down();

  service.settings.build = "another build";
  service.up();
  service.runner.wait_started(3);
  CHECK_FALSE(service.runner.last_task.checkpoint.has_value());
  service.down();

  service.settings.build = "0123456789abcdef-one";
  service.runner.behaviour = FakeRunner::Behaviour::succeed;
  service.up();
  CHECK(service.finished(id).state == JobState::succeeded);
  service.down();
  CHECK_FALSE(std::filesystem::exists(kept));
}

TEST_CASE("a job that the service died with three times is given up") {
  Service service;
  service.down();
  {
    // As a service that was killed leaves it.
    server::JobStore store(service.directory.path / "jobs.sqlite");
    server::StoredJob stored;
    stored.job.id = "01J0000000000000000000000A";
    stored.job.state = JobState::running;
    stored.job.attempt = 3;
    stored.inputs.push_back({"model", 1});
    store.insert(stored);
  }
  service.up();
  const api::Job job = service.scheduler->find("01J0000000000000000000000A").value();
  CHECK(job.state == JobState::failed);
  CHECK(job.problem->detail.find("3 times") != std::string::npos);
}

TEST_CASE("draining refuses new jobs and keeps the queued ones") {
  Service service(FakeRunner::Behaviour::hang);
  const api::Job running = service.submit();
  service.runner.wait_started(1);
  const api::Job queued = service.submit();
  service.scheduler->drain(std::chrono::milliseconds(0));
  CHECK(service.scheduler->draining());
  CHECK(refusal_status([&] { (void)service.submit(); }) == 503);
  CHECK(service.scheduler->find(running.id)->state == JobState::queued);
  CHECK(service.scheduler->find(queued.id)->state == JobState::queued);
}

TEST_CASE("draining lets running jobs finish") {
  Service service(FakeRunner::Behaviour::hang);
  const api::Job running = service.submit();
  service.runner.wait_started(1);
  // Who waits goes on waiting while it may still end.
  std::optional<api::Job> seen;
  std::jthread waiter([&] {
    const std::uint64_t version = service.scheduler->find(running.id)->version;
    seen = service.scheduler->wait(running.id, version, std::chrono::seconds(60));
  });
  const std::jthread releaser([&] {
    while (!service.scheduler->draining()) std::this_thread::yield();
    service.runner.release();
  });
  CHECK_FALSE(service.scheduler->stopped());
  service.scheduler->drain(std::chrono::seconds(60));
  CHECK(service.scheduler->stopped());
  waiter.join();
  REQUIRE(seen.has_value());
  CHECK(seen->state == JobState::failed);
  CHECK(service.scheduler->find(running.id)->state == JobState::failed); // as released: by itself, not stopped
  CHECK(service.scheduler->find(running.id)->problem->detail == "released");
}

TEST_CASE("the same Idempotency-Key is the same job; another request under it is refused") {
  Service service;
  const api::Job first = service.submit("key");
  CHECK(service.submit("key").id == first.id);
  CHECK(refusal_status([&] { (void)service.submit("key", "glTF other"); }) == 422);
  CHECK(service.submit("another key").id != first.id);
  service.restart();
  CHECK(service.submit("key").id == first.id);
}

TEST_CASE("files are deleted when their time is over, and the job says so") {
  Service service;
  const api::Job job = service.finished(service.submit().id);
  const auto file = service.scheduler->file(job.id, api::JobFile::result)->path;
  service.scheduler->collect_garbage(*job.expires - std::chrono::seconds(1));
  CHECK(std::filesystem::exists(file));
  service.scheduler->collect_garbage(*job.expires);
  CHECK_FALSE(std::filesystem::exists(file));
  CHECK(service.scheduler->find(job.id)->state == JobState::expired);
  CHECK_FALSE(service.scheduler->file(job.id, api::JobFile::result).has_value());
  service.scheduler->collect_garbage(*job.expires + std::chrono::days(31));
  CHECK_FALSE(service.scheduler->find(job.id).has_value());
}

TEST_CASE("what has expired is not served, whether it was collected or not") {
  Service service;
  service.settings.time_to_live = std::chrono::seconds(0);
  service.restart();
  const api::Job job = service.finished(service.submit("key").id);
  CHECK(service.scheduler->find(job.id)->state == JobState::expired);
  CHECK(service.scheduler->list({}).items.at(0).state == JobState::expired);
  const api::Job again = service.submit("key", "glTF other"); // the key is free
  CHECK(again.id != job.id);
  (void)service.finished(again.id);
  CHECK_FALSE(service.scheduler->file(job.id, api::JobFile::result).has_value());
}

TEST_CASE("files that no job owns are removed at the start") {
  Service service;
  service.down();
  std::filesystem::create_directories(service.directory.path / "jobs" / "01JORPHAN");
  std::ofstream(service.directory.path / "spool" / "left") << "x";
  service.up();
  CHECK_FALSE(std::filesystem::exists(service.directory.path / "jobs" / "01JORPHAN"));
  CHECK_FALSE(std::filesystem::exists(service.directory.path / "spool" / "left"));
}

TEST_CASE("the list is newest first, in pages, by state") {
  Service service;
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(service.finished(service.submit().id).id);
  CHECK(std::ranges::is_sorted(ids));
  const api::JobPage first = service.scheduler->list({std::nullopt, 3, ""});
  REQUIRE(first.items.size() == 3);
  CHECK(first.items.front().id == ids.back());
  const api::JobPage second = service.scheduler->list({std::nullopt, 3, first.next_cursor});
  CHECK(second.items.size() == 2);
  CHECK(second.next_cursor.empty());
  CHECK(service.scheduler->list({JobState::failed, 3, ""}).items.empty());
}

TEST_CASE("the metrics count what happened") {
  Service service;
  (void)service.finished(service.submit().id);
  service.scheduler->drain(std::chrono::milliseconds(0)); // until its worker has counted it
  const std::string text = service.scheduler->metrics();
  CHECK(text.find("orbis_jobs_accepted_total 1\n") != std::string::npos);
  CHECK(text.find("orbis_jobs_finished_total{state=\"succeeded\"} 1\n") != std::string::npos);
  CHECK(text.find("orbis_stage_seconds_total{stage=\"refine\"} 0.005\n") != std::string::npos);
}

TEST_CASE("a request that was answered before is answered from there, as a job of its own") {
  Service service;
  const api::Job first = service.finished(service.submit().id);
  const api::Job again = service.submit();
  CHECK(again.id != first.id);
  CHECK(again.state == JobState::succeeded);
  CHECK(again.cached);
  CHECK_FALSE(first.cached);
  CHECK(again.result->sha256 == first.result->sha256);
  CHECK(again.input.triangles == first.input.triangles);
  CHECK(service.scheduler->find(again.id)->cached);
  CHECK(service.scheduler->list({}).items.size() == 2);
  CHECK(service.metrics.text({}).find("orbis_jobs_cached_total 1\n") != std::string::npos);
  service.runner.wait_started(1);
  CHECK(std::filesystem::exists(service.scheduler->file(again.id, api::JobFile::result)->path));
}

TEST_CASE(
    "other bytes, other options, another build, a failed job and a cache that is off are not answered from before") {
  Service service;
  service.finished(service.submit().id);
  CHECK_FALSE(service.submit("", "glTF and more").cached);
  CHECK_FALSE(service.submit("", "glTF", "texture_size", "512").cached);
  CHECK(service.submit("", "glTF", "threads", "3").cached); // changes nothing in the result
  service.settings.build = "another";
  service.restart();
  CHECK_FALSE(service.submit().cached);
  service.settings.cache = false;
  service.restart();
  service.finished(service.submit().id);
  CHECK_FALSE(service.submit().cached);

  Service failing(FakeRunner::Behaviour::fail);
  failing.finished(failing.submit().id);
  CHECK_FALSE(failing.submit().cached);
}

TEST_CASE("what the cache gave outlives the job that it came from; what has expired is made again") {
  Service service;
  const api::Job first = service.finished(service.submit().id);
  std::this_thread::sleep_for(std::chrono::milliseconds(2)); // expiry is told in milliseconds
  const api::Job again = service.submit();
  service.scheduler->collect_garbage(*first.expires);
  CHECK(service.scheduler->find(first.id)->state == JobState::expired);
  CHECK(std::filesystem::exists(service.scheduler->file(again.id, api::JobFile::result)->path));
  CHECK(service.submit().cached);
  service.scheduler->collect_garbage(api::now() + std::chrono::hours(25));
  CHECK_FALSE(service.submit().cached);
}
