// The contract itself, and the shapes of what is made into JSON.
#include <doctest/doctest.h>

#include <set>

#include "api/contract.h"
#include "api/json.h"
#include "api/openapi.h"
#include "core/options.h"
#include "core/report.h"

using namespace orbis;
using nlohmann::json;

namespace {

json schema(const std::string& name) { return {{"$ref", "#/components/schemas/" + name}}; }

json plain(const api::Json& ordered) { return json::parse(ordered.dump()); }

api::Job full_job() {
  api::Job job;
  job.id = "01J0000000000000000000000A";
  job.state = api::JobState::succeeded;
  job.created = api::Time(std::chrono::milliseconds(0));
  job.started = job.finished = job.expires = job.created + std::chrono::milliseconds(1);
  job.queue_position = 3;
  job.attempt = 2;
  job.progress = api::JobProgress{Stage::refine, 120'000, 400'000, 42, api::TimeToGo{800, 1400}};
  job.timing = {12.0, 4821.0, 9010.0, 81'200'000, {{"decode", 33, 30}, {"refine", 450, 800}}};
  job.input = {std::string(64, 'a'), 10, 96'966};
  job.result = api::JobResult{std::string(64, 'b'), 1};
  job.problem = api::make_problem(Error(ErrorCode::not_genus_zero, "two components", "/meshes/0"));
  return job;
}

} // namespace

TEST_CASE("the contract is OpenAPI 3.1 and has every option under its one name, with its default") {
  CHECK(test::contract()["openapi"] == "3.1.0");
  const json options = test::contract()["components"]["schemas"]["Options"];
  CHECK(options["properties"].size() == option_table().size());
  const json defaults = plain(api::to_json(Options{}));
  for (const OptionInfo& info : option_table()) {
    CAPTURE(info.name);
    const std::string name(info.name);
    REQUIRE(options["properties"].contains(name));
    CHECK(options["properties"][name]["default"] == defaults[name]);
  }
}

TEST_CASE("the contract names every stage and every state") {
  const json& schemas = test::contract()["components"]["schemas"];
  CHECK(schemas["StageName"]["enum"] == json(stage_names));
  CHECK(schemas["State"]["enum"] == json(api::job_state_names));
}

TEST_CASE("a job has the contract's shape, whether all or nothing is known about it") {
  CHECK(test::against_schema(plain(api::to_json(full_job())), schema("Job")) == "");
  api::Job bare;
  bare.id = "01J0000000000000000000000A";
  bare.input.sha256 = std::string(64, '0');
  const json queued = plain(api::to_json(bare));
  CHECK(test::against_schema(queued, schema("Job")) == "");
  CHECK(queued["progress"].is_null());
  CHECK(queued["links"]["self"] == "/v1/jobs/01J0000000000000000000000A");
  CHECK_FALSE(queued["links"].contains("result"));
}

TEST_CASE("the stage index counts from 1 to the number of stages") {
  const json progress = plain(api::to_json(full_job()))["progress"];
  CHECK(progress["stage"] == "refine");
  CHECK(progress["stage_index"] == 4);
  CHECK(progress["stages"] == stage_count);
}

TEST_CASE("a report has the contract's shape") {
  Report report;
  report.format = "glb";
  report.atlas.pages = {{2048, 1024}};
  report.atlas.source = "pattern";
  report.stages = {{Stage::decode, 1.5, 1.0}, {Stage::certify, 2.5, 2.0}};
  report.notes = {{"turned", "2 triangles were turned", "/meshes/0"}};
  const json body = plain(api::to_json(report));
  CHECK(test::against_schema(body, schema("Report")) == "");
  CHECK(body["timing"]["wall_ms"] == 4.0);
}

TEST_CASE("the schema checker sees what is wrong") {
  json job = plain(api::to_json(full_job()));
  job["state"] = "sleeping";
  CHECK(test::against_schema(job, schema("Job")).find("/state") != std::string::npos);
  job = plain(api::to_json(full_job()));
  job.erase("attempt");
  CHECK(test::against_schema(job, schema("Job")).find("attempt") != std::string::npos);
  job = plain(api::to_json(full_job()));
  job["progress"]["percent"] = 101;
  CHECK_FALSE(test::against_schema(job, schema("Job")).empty());
  job = plain(api::to_json(full_job()));
  job["surprise"] = 1;
  CHECK_FALSE(test::against_schema(job, schema("Job")).empty());
}

TEST_CASE("every option is a query parameter of the contract, where it applies") {
  const auto listed = [](const std::string& path) {
    std::set<std::string> names;
    for (const json& parameter : test::contract()["paths"][path]["post"]["parameters"])
      if (parameter.contains("in") && parameter["in"] == "query") names.insert(parameter["name"]);
    return names;
  };
  std::set<std::string> options;
  for (const OptionInfo& option : option_table()) options.insert(std::string(option.name));
  CHECK(listed("/v1/jobs") == options);
  // A morph's second model is a part of the form, and it has the one target.
  options.erase("morph_to");
  options.erase("sphere_morph");
  CHECK(listed("/v1/morphs") == options);
}

TEST_CASE("times are RFC 3339 in UTC with milliseconds") {
  CHECK(api::rfc3339(api::Time(std::chrono::milliseconds(0))) == "1970-01-01T00:00:00.000Z");
  CHECK(api::rfc3339(api::Time(std::chrono::milliseconds(1'709'210'096'007))) == "2024-02-29T12:34:56.007Z");
}

TEST_CASE("options, timings and problems come back from their JSON as they went in") {
  Options options;
  options.objective = Objective::shape_preserving;
  options.threshold = 0.9;
  options.texture_size = 512;
  CHECK(api::to_json(api::options_from_json(api::to_json(options))) == api::to_json(options));
  const api::Job job = full_job();
  CHECK(api::to_json(api::timing_from_json(api::to_json(job.timing))) == api::to_json(job.timing));
  CHECK(api::problem_from_json(api::to_json(*job.problem)) == *job.problem);
}

TEST_CASE("progress over all stages never falls and ends at 100 percent") {
  double last = 0;
  for (std::size_t stage = 0; stage < stage_count; ++stage) {
    for (const std::uint64_t done : {0, 1, 5, 10}) {
      const double percent = api::overall_percent(static_cast<Stage>(stage), done, 10);
      CHECK(percent >= last);
      last = percent;
    }
  }
  CHECK(last == doctest::Approx(100));
}
