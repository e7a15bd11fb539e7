// Every answer here is checked against the contract by ask().
#include <doctest/doctest.h>

#include "api/contract.h"
#include "api/fake_service.h"
#include "api/json.h"
#include "api/router.h"
#include "support/temporary_directory.h"

using namespace orbis;
using nlohmann::json;

namespace {

struct Desk {
  test::FakeService service;
  api::RouterSettings settings;
  test::TemporaryDirectory directory;

  api::Response ask(const api::Request& request) {
    api::Router router(service, settings);
    api::Response response = router.handle(request);
    CHECK(test::against_contract(request, response) == "");
    return response;
  }
  api::Response ask(const std::string& method, const std::string& path, api::Fields headers = {},
                    api::Fields query = {}) {
    return ask({method, path, std::move(query), std::move(headers), {}});
  }
  api::Part part(const std::string& name, const std::string& file_name, const std::string& contents) const {
    static int number = 0;
    return {
        name, file_name, "", directory.file(std::to_string(number++), contents), contents.size(), std::string(64, 'a')};
  }
  api::Response post(std::vector<api::Part> parts, api::Fields query = {}, api::Fields headers = {}) {
    return ask({"POST", "/v1/jobs", std::move(query), std::move(headers), std::move(parts)});
  }
  api::Response post_model(api::Fields query = {}, api::Fields headers = {}) {
    return post({part("model", "", "glTF....")}, std::move(query), std::move(headers));
  }
  // A job in some state, with a result of ten bytes where it has succeeded.
  std::string job(api::JobState state) {
    api::Job job;
    job.id = "01J0000000000000000000000" + std::string(1, static_cast<char>('A' + service.jobs.size()));
    job.state = state;
    job.input.sha256 = std::string(64, 'a');
    if (state == api::JobState::failed) job.problem = api::make_problem(Error(ErrorCode::not_genus_zero, "a torus"));
    if (state == api::JobState::succeeded) {
      job.result = api::JobResult{std::string(64, 'b'), 10};
      job.timing = {5.0, 100.0, 90.0, 1, {{"refine", 60, 55}}};
      service.files[api::JobFile::result] = {directory.file("result.glb", "0123456789"), 10, std::string(64, 'b')};
      job.maps = {"normal.png"};
      service.maps["normal.png"] = {directory.file("map-normal.png", "PNG"), 3, std::string(64, 'd')};
      service.files[api::JobFile::report] = {directory.file("report.json", "{}"), 2, std::string(64, 'c')};
    }
    service.jobs[job.id] = job;
    return "/v1/jobs/" + job.id;
  }
};

json body_of(const api::Response& response) { return json::parse(std::get<std::string>(response.body)); }

} // namespace

TEST_CASE_FIXTURE(Desk, "a model that is posted is a job: 202, Location, Retry-After, the job") {
  const auto response = post_model({{"texture_size", "512"}});
  CHECK(response.status == 202);
  CHECK(response.header("Location") == "/v1/jobs/" + body_of(response)["id"].get<std::string>());
  CHECK(response.header("Retry-After") == "1");
  CHECK(body_of(response)["options"]["texture_size"] == 512);
}

TEST_CASE_FIXTURE(Desk, "the maps of a job are listed in its links and served under their names") {
  const std::string address = job(api::JobState::succeeded);
  const json links = body_of(ask({"GET", address, {}, {}, {}}))["links"];
  CHECK(links["maps"] == json{{"normal.png", address + "/maps/normal.png"}});
  const auto map = ask({"GET", address + "/maps/normal.png", {}, {}, {}});
  CHECK(map.status == 200);
  CHECK(map.header("Content-Type") == "image/png");
  CHECK(map.header("ETag") == "\"" + std::string(64, 'd') + "\"");
  CHECK(ask({"GET", address + "/maps/emissive.png", {}, {}, {}}).status == 404);
  CHECK(ask({"POST", address + "/maps/normal.png", {}, {}, {}}).status == 405);
  CHECK(ask({"GET", job(api::JobState::running) + "/maps/normal.png", {}, {}, {}}).status == 409);
}

TEST_CASE_FIXTURE(Desk,
                  "two models that are posted are a job too: the second goes along as the file that an option names") {
  const auto morph = [&](std::vector<api::Part> parts, api::Fields query = {}) {
    return ask({"POST", "/v1/morphs", std::move(query), {}, std::move(parts)});
  };
  const auto response = morph({part("a", "cow.glb", "glTF...."), part("b", "horse.glb", "glTF....")},
                              {{"features", "[[[0,0,1],[0,2,0.5]]]"}});
  CHECK(response.status == 202);
  const json body = body_of(response);
  CHECK(response.header("Location") == "/v1/jobs/" + body["id"].get<std::string>());
  CHECK(body["options"]["morph_to"] == "horse.glb");
  CHECK(body["options"]["features"] == "[[[0,0,1],[0,2,0.5]]]");
  REQUIRE(service.submissions.size() == 1);
  CHECK(service.submissions[0].model.file_name == "cow.glb");
  CHECK(service.submissions[0].files.at(0).file_name == "horse.glb");

  CHECK(morph({part("a", "cow.glb", "glTF....")}).status == 400);
  CHECK(morph({part("b", "cow.glb", "glTF....")}).status == 400);
  const auto single = morph({part("model", "", "glTF....")});
  CHECK(single.status == 400);
  CHECK(body_of(single)["detail"].get<std::string>().find("'a' and 'b'") != std::string::npos);
  CHECK(morph({part("a", "", "glTF...."), part("b", "b.glb", "not a model")}).status == 415);
  CHECK(morph({part("a", "", "glTF...."), part("b", "b.glb", "glTF....")}, {{"morph_to", "c.glb"}}).status == 400);
  CHECK(morph({part("a", "", "glTF...."), part("b", "b.glb", "glTF....")}, {{"features", "nose"}}).status == 422);
  CHECK(ask("GET", "/v1/morphs").status == 405);
  CHECK(ask("GET", "/v1/morphs").header("Allow") == "POST");
}

TEST_CASE_FIXTURE(Desk, "a list in the options part is what the query would have with commas") {
  const auto response =
      post({part("model", "m.glb", "glTF...."), part("file", "b.glb", "glTF...."),
            part("options", "", R"({"lods": [0.5, 0.25], "maps": ["normal", "position"], "morph_to": "b.glb",
                 "features": [[[0,0,1],[0,0,2]]]})")});
  CHECK(response.status == 202);
  CHECK(body_of(response)["options"]["lods"] == "0.5,0.25");
  CHECK(body_of(response)["options"]["maps"] == "normal,position");
  CHECK(body_of(response)["options"]["features"] == "[[[0,0,1],[0,0,2]]]");
}

TEST_CASE_FIXTURE(Desk, "what is wrong with a list of levels is said") {
  const auto why = [&](const std::string& lods) {
    const auto response = post_model({{"lods", lods}});
    CHECK(response.status == 422);
    return body_of(response)["detail"].get<std::string>();
  };
  CHECK(why("2").find("four at least") != std::string::npos);
  CHECK(why("0.1,0.5").find("from fine to coarse") != std::string::npos);
  CHECK(why("deviation:101").find("100 per cent") != std::string::npos);
  CHECK(why("0.9,0.8,0.7,0.6,0.5,0.4,0.3,0.2,0.1").find("8 are the most") != std::string::npos);
  CHECK(why("0.5,half").find("'half'") != std::string::npos);
}

TEST_CASE_FIXTURE(Desk, "options come from the query and from the options part, and the query wins") {
  const auto response = post({part("model", "m.glb", "glTF...."),
                              part("options", "", R"({"texture_size": 256, "objective": "shape-preserving"})")},
                             {{"texture_size", "1024"}});
  CHECK(response.status == 202);
  CHECK(body_of(response)["options"]["texture_size"] == 1024);
  CHECK(body_of(response)["options"]["objective"] == "shape-preserving");
}

TEST_CASE_FIXTURE(Desk, "every bad option is named, unknown ones too") {
  const auto response = post_model({{"texture_size", "3"}, {"colour", "red"}});
  CHECK(response.status == 422);
  const json errors = body_of(response)["errors"];
  REQUIRE(errors.size() == 2);
  CHECK(errors[0]["pointer"] == "/colour");
  CHECK(errors[1]["pointer"] == "/texture_size");
  CHECK(service.submissions.empty());
}

TEST_CASE_FIXTURE(Desk, "what is given twice is refused, and pointers are escaped") {
  const auto response = post_model({{"texture_size", "256"}, {"texture_size", "512"}, {"a/b~c", "1"}});
  CHECK(response.status == 422);
  const json errors = body_of(response)["errors"];
  REQUIRE(errors.size() == 2);
  CHECK(errors[0]["detail"] == "'texture_size' is given twice");
  CHECK(errors[1]["pointer"] == "/a~1b~0c");
  const api::Part model = part("model", "", "glTF"), options = part("options", "", "{}"),
                  file = part("f", "a.bin", "1");
  CHECK(post({model, options, options}).status == 400);
  CHECK(post({model, file, file}).status == 400);
}

TEST_CASE_FIXTURE(Desk, "a number without a fraction is an integer, however it is written") {
  const auto response = post({part("model", "", "glTF...."), part("options", "", R"({"texture_size": 2.56e2})")});
  CHECK(response.status == 202);
  CHECK(body_of(response)["options"]["texture_size"] == 256);
  CHECK(post({part("model", "", "glTF...."), part("options", "", R"({"texture_size": 256.5})")}).status == 422);
}

TEST_CASE_FIXTURE(Desk, "an options part that is no JSON object is refused") {
  for (const char* text : {"", "[]", "{", "texture_size=3", R"({"a":{"b":{"c":{"d":{"e":{}}}}}})"}) {
    CAPTURE(text);
    const auto response = post({part("model", "", "glTF"), part("options", "", text)});
    CHECK(response.status >= 400);
    CHECK(response.status <= 422);
  }
}

TEST_CASE_FIXTURE(Desk, "parts by file name go with the job") {
  CHECK(post({part("model", "m.gltf", " {}"), part("file", "m.bin", "1"), part("anything", "px.png", "2")}).status ==
        202);
  REQUIRE(service.submissions.size() == 1);
  CHECK(service.submissions[0].files.size() == 2);
  CHECK(service.submissions[0].files[1].file_name == "px.png");
}

TEST_CASE_FIXTURE(Desk, "a request without a model, with two, or with a nameless part is refused") {
  CHECK(post({}).status == 400);
  CHECK(post({part("model", "", "")}).status == 400);
  CHECK(post({part("model", "", "glTF"), part("model", "", "glTF")}).status == 400);
  CHECK(post({part("model", "", "glTF"), part("file", "", "1")}).status == 400);
}

TEST_CASE_FIXTURE(Desk, "the format is recognised by content, and what cannot be a model is refused at the door") {
  CHECK(post({part("model", "", "glTF")}).status == 202);
  CHECK(post({part("model", "", "DRACO")}).status == 202);
  CHECK(post({part("model", "", "\xEF\xBB\xBF {\"asset\":{}}")}).status == 202);
  for (const auto text : {"PK\x03\x04....", "ply\nformat ascii 1.0\n", "solid cube\n", "# a comment\nv 0 0 0\n"}) {
    CHECK(post({part("model", "", text)}).status == 202);
  }
  const auto refused = post({part("model", "", "hello")});
  CHECK(refused.status == 415);
  CHECK(body_of(refused)["detail"].get<std::string>().find("STL") != std::string::npos);
}

// A job that could not work was accepted, and failed after the whole unfolding.
TEST_CASE_FIXTURE(Desk, "options that need a file which did not come, or each other, are refused at the door") {
  const auto refused = [&](api::Fields query, std::vector<api::Part> files = {}) {
    files.push_back(part("model", "", "glTF...."));
    const auto response = post(std::move(files), std::move(query));
    CHECK(response.status == 422);
    const json problem = body_of(response);
    return problem["type"].get<std::string>() + " " + problem["errors"][0]["pointer"].get<std::string>();
  };
  CHECK(refused({{"texture", "cubemap"}}) == "/problems/missing-resource /texture");
  CHECK(refused({{"texture", "cubemap"}}, {part("file", "px.png", "1")}) == "/problems/missing-resource /texture");
  CHECK(refused({{"morph_to", "x.glb"}}) == "/problems/missing-resource /morph_to");
  CHECK(refused({{"features", "[[[0,0,1],[0,0,2]]]"}}) == "/problems/invalid-option /features");
  CHECK(refused({{"morph_to", "x.glb"}, {"sphere_morph", "true"}}, {part("file", "x.glb", "glTF....")}) ==
        "/problems/invalid-option /sphere_morph");
  CHECK(service.submissions.empty());
  CHECK(post({part("model", "", "glTF...."), part("file", "x.glb", "hello")}, {{"morph_to", "x.glb"}}).status == 415);
  CHECK(post({part("model", "", "glTF...."), part("file", "x.glb", "glTF....")}, {{"morph_to", "x.glb"}}).status ==
        202);
  CHECK(post({part("model", "", "glTF...."), part("file", "equirectangular.jpg", "1")}, {{"texture", "cubemap"}})
            .status == 202);
}

TEST_CASE_FIXTURE(Desk, "media types that are not in the contract are refused before the body is read") {
  api::Router router(service, settings);
  const auto early = [&](const std::string& type) {
    return router.refuse_early({"POST", "/v1/jobs", {}, {{"Content-Type", type}}, {}});
  };
  for (const auto type : {"model/gltf-binary", "model/obj", "model/stl", "application/ply", "application/zip"}) {
    CHECK_FALSE(early(type).has_value());
  }
  CHECK_FALSE(early("Multipart/Form-Data; boundary=x").has_value());
  CHECK(early("text/html")->status == 415);
  CHECK_FALSE(early("application/x-www-form-urlencoded").has_value()); // what curl says unless told otherwise
}

TEST_CASE_FIXTURE(Desk, "with Prefer wait a job that is done in time answers with its file") {
  job(api::JobState::succeeded);
  service.on_wait = [](api::Job& job) {
    job.state = api::JobState::succeeded;
    job.result = api::JobResult{std::string(64, 'b'), 10};
  };
  const auto response = post_model({}, {{"Prefer", "wait=30"}});
  CHECK(response.status == 200);
  CHECK(response.header("Content-Type") == "model/gltf-binary");
  CHECK(response.header("Preference-Applied") == "wait=30");
  CHECK_FALSE(response.header("Location").empty());
  CHECK(std::get<api::FileBody>(response.body).length == 10);
}

TEST_CASE_FIXTURE(Desk, "with Prefer wait a job that fails in time answers with its problem") {
  service.on_wait = [](api::Job& job) {
    job.state = api::JobState::failed;
    job.problem = api::make_problem(Error(ErrorCode::not_genus_zero, "a torus"));
  };
  const auto response = post_model({}, {{"Prefer", "wait=30"}});
  CHECK(response.status == 422);
  CHECK(body_of(response)["type"] == "/problems/not-genus-zero");
  CHECK(body_of(response)["instance"] == response.header("Location"));
}

TEST_CASE_FIXTURE(Desk, "with Prefer wait a job that takes longer is answered with 202") {
  const auto response = post_model({}, {{"Prefer", "wait=0"}});
  CHECK(response.status == 202);
  CHECK(response.header("Preference-Applied") == "wait=0");
}

TEST_CASE_FIXTURE(Desk, "a job has an entity tag, and is not sent again while it stays the same") {
  const std::string address = job(api::JobState::running);
  const std::string etag(ask("GET", address).header("ETag"));
  CHECK_FALSE(etag.empty());
  const auto same = ask("GET", address, {{"If-None-Match", etag}});
  CHECK(same.status == 304);
  CHECK(same.header("ETag") == etag);
  CHECK(std::get<std::string>(same.body).empty());
  service.jobs.begin()->second.state = api::JobState::canceled;
  CHECK(ask("GET", address, {{"If-None-Match", etag}}).status == 200);
}

TEST_CASE_FIXTURE(Desk, "a long poll ends when the state changes") {
  const std::string address = job(api::JobState::queued);
  service.on_wait = [](api::Job& job) { job.state = api::JobState::running; };
  const auto response = ask("GET", address, {{"Prefer", "wait=60"}});
  CHECK(body_of(response)["state"] == "running");
  CHECK(response.header("Preference-Applied") == "wait=60");
}

TEST_CASE_FIXTURE(Desk, "a result is a file with tag, name and timing") {
  const auto response = ask("GET", job(api::JobState::succeeded) + "/result");
  CHECK(response.status == 200);
  CHECK(response.header("ETag") == "\"" + std::string(64, 'b') + "\"");
  CHECK(response.header("Content-Disposition").find(".glb") != std::string_view::npos);
  CHECK(response.header("Server-Timing") == "queue;dur=5.0, refine;dur=60.0, total;dur=100.0");
  CHECK(response.header("Accept-Ranges") == "bytes");
}

TEST_CASE_FIXTURE(Desk, "a result can be had in ranges, if it is still the same") {
  const std::string address = job(api::JobState::succeeded) + "/result";
  const auto part = ask("GET", address, {{"Range", "bytes=2-4"}});
  CHECK(part.status == 206);
  CHECK(part.header("Content-Range") == "bytes 2-4/10");
  CHECK(std::get<api::FileBody>(part.body).offset == 2);
  CHECK(std::get<api::FileBody>(part.body).length == 3);
  const auto beyond = ask("GET", address, {{"Range", "bytes=10-"}});
  CHECK(beyond.status == 416);
  CHECK(beyond.header("Content-Range") == "bytes */10");
  CHECK(ask("GET", address, {{"Range", "bytes=2-4"}, {"If-Range", "\"other\""}}).status == 200);
  CHECK(ask("GET", address, {{"If-None-Match", "\"" + std::string(64, 'b') + "\""}}).status == 304);
}

TEST_CASE_FIXTURE(Desk,
                  "there is no result before the end, and none of a job that failed, was canceled or has expired") {
  CHECK(ask("GET", job(api::JobState::queued) + "/result").status == 409);
  CHECK(ask("GET", job(api::JobState::running) + "/report").status == 409);
  CHECK(ask("GET", job(api::JobState::canceled) + "/result").status == 409);
  CHECK(ask("GET", job(api::JobState::expired) + "/result").status == 410);
  const auto failed = ask("GET", job(api::JobState::failed) + "/result");
  CHECK(failed.status == 422);
  CHECK(body_of(failed)["type"] == "/problems/not-genus-zero");
}

TEST_CASE_FIXTURE(Desk, "canceling is repeatable") {
  const std::string address = job(api::JobState::running);
  CHECK(body_of(ask("DELETE", address))["state"] == "canceled");
  CHECK(body_of(ask("DELETE", address))["state"] == "canceled");
}

TEST_CASE_FIXTURE(Desk, "pages of the list hold together, and every job is on one") {
  for (int i = 0; i < 5; ++i) job(i < 3 ? api::JobState::queued : api::JobState::canceled);
  std::string cursor;
  std::vector<std::string> seen;
  for (int page = 0; page < 3; ++page) {
    const auto response = ask("GET", "/v1/jobs", {}, {{"limit", "2"}, {"cursor", cursor}});
    CHECK(ask("GET", "/v1/jobs", {}, {{"cursor", "foo"}}).status == 400);
    const json body = body_of(response);
    for (const json& item : body["items"]) seen.push_back(item["id"]);
    CHECK(response.header("Link").empty() == body["next_cursor"].is_null());
    if (!body["next_cursor"].is_null()) cursor = body["next_cursor"];
  }
  CHECK(seen.size() == 5);
  CHECK(std::ranges::is_sorted(seen, std::greater<>()));
  CHECK(body_of(ask("GET", "/v1/jobs", {}, {{"state", "canceled"}}))["items"].size() == 2);
}

TEST_CASE_FIXTURE(Desk, "parameters of the list that make no sense are refused") {
  for (const api::Fields& query : {api::Fields{{"limit", "0"}},
                                   {{"limit", "101"}},
                                   {{"limit", "x"}},
                                   {{"limit", ""}},
                                   {{"state", "asleep"}},
                                   {{"page", "2"}}}) {
    CHECK(ask("GET", "/v1/jobs", {}, query).status == 400);
  }
}

TEST_CASE_FIXTURE(Desk, "a full queue is 429 and a service that shuts down 503, both with Retry-After") {
  service.is_full = true;
  CHECK(post_model().status == 429);
  // An earlier job's key takes no place in the queue; others are refused before their model is read.
  service.known_key = "k1";
  api::Router router(service, settings);
  CHECK_FALSE(router.refuse_early({"POST", "/v1/jobs", {}, {{"Idempotency-Key", "k1"}}, {}}).has_value());
  CHECK(router.refuse_early({"POST", "/v1/jobs", {}, {{"Idempotency-Key", "k2"}}, {}}).value().status == 429);
  CHECK(service.refusals == 1); // the service counts what does not come to it
  CHECK(post_model({}, {{"Idempotency-Key", "k1"}}).status == 202);
  CHECK(ask("GET", "/readyz").status == 200);
  service.is_draining = true;
  const auto draining = post_model();
  CHECK(draining.status == 503);
  CHECK(draining.header("Retry-After") == "7");
  CHECK(ask("GET", "/readyz").status == 503);
  CHECK(ask("GET", "/livez").status == 200);
}

TEST_CASE_FIXTURE(Desk, "where keys are configured only their holders have access, but probes need none") {
  settings.keys = {"secret", "another"};
  CHECK(ask("GET", "/v1/jobs").status == 401);
  CHECK(ask("GET", "/v1/jobs", {{"Authorization", "Basic secret"}}).status == 401);
  CHECK(ask("GET", "/v1/jobs", {{"Authorization", "Bearer wrong"}}).status == 403);
  CHECK(ask("GET", "/v1/jobs", {{"authorization", "bearer another"}}).status == 200);
  CHECK(ask("GET", "/livez").status == 200);
  CHECK(ask("GET", "/metrics").status == 200);
}

TEST_CASE_FIXTURE(Desk, "unknown addresses are 404, other methods 405 with Allow") {
  CHECK(ask("GET", "/v2").status == 404);
  CHECK(ask("GET", "/v1/jobs/nothing").status == 404);
  CHECK(ask("DELETE", "/v1/jobs/nothing").status == 404);
  CHECK(ask("GET", job(api::JobState::succeeded) + "/secrets").status == 404);
  CHECK(ask("DELETE", "/v1/jobs").header("Allow") == "GET, POST");
  CHECK(ask("PUT", job(api::JobState::queued)).status == 405);
  CHECK(ask("POST", "/livez").status == 405);
}

TEST_CASE_FIXTURE(Desk, "HEAD answers as GET does") {
  CHECK(ask("HEAD", "/livez").status == 200);
  CHECK(ask("HEAD", job(api::JobState::succeeded) + "/result").status == 200);
}

TEST_CASE_FIXTURE(Desk, "the contract and the types of problems can be read") {
  CHECK(body_of(ask("GET", "/openapi.json"))["openapi"] == "3.1.0");
  CHECK(body_of(ask("GET", "/problems/not-genus-zero"))["status"] == 422);
  CHECK(ask("GET", "/problems/bad-luck").status == 404);
}

TEST_CASE_FIXTURE(Desk, "an exception of a library tells the client nothing about it") {
  service.on_submit = [](api::Job&) { throw std::runtime_error("/etc/secret: library text"); };
  const auto response = post_model();
  CHECK(response.status == 500);
  CHECK(std::get<std::string>(response.body).find("secret") == std::string::npos);
}

TEST_CASE_FIXTURE(Desk, "events tell of states, stages and progress, and end with the job") {
  const std::string address = job(api::JobState::running);
  int step = 0;
  service.on_wait = [&](api::Job& job) {
    ++job.version;
    if (++step <= 2)
      job.progress = api::JobProgress{step == 1 ? Stage::decode : Stage::refine, 1, 2, 10.0 * step, {}};
    else
      job.state = api::JobState::succeeded;
  };
  api::Router router(service, settings);
  const auto response = router.handle({"GET", address + "/events", {}, {}, {}});
  CHECK(response.header("Content-Type") == "text/event-stream");
  const auto& next = std::get<api::StreamBody>(response.body);
  std::string all;
  while (const auto piece = next()) all += *piece;
  CHECK(all.find("event: state") < all.find("\"state\":\"succeeded\""));
  CHECK(all.find("\"stage\":\"decode\"") < all.find("\"stage\":\"refine\""));
  CHECK(all.find("event: progress") != std::string::npos);
  CHECK(all.find("id: 3\n") != std::string::npos);
  // Of the events that come together the last one alone has the id: who missed one of them gets all of them again.
  for (std::size_t at = all.find("id: "); at != std::string::npos; at = all.find("id: ", at + 1)) {
    const std::string id = all.substr(at, all.find('\n', at) + 1 - at);
    CHECK(all.find(id, at + 1) == std::string::npos);
  }
  // The last event was seen: an EventSource that comes back is told to stop.
  CHECK(ask("GET", address + "/events", {{"Last-Event-ID", "3"}}).status == 204);
  CHECK(ask("GET", address + "/events", {{"Last-Event-ID", "x"}}).status == 400);
}

TEST_CASE_FIXTURE(Desk, "places for requests that wait are bounded") {
  settings.max_waiting = 0;
  const std::string address = job(api::JobState::running);
  CHECK(ask("GET", address + "/events").status == 429);
  service.on_wait = [](api::Job&) { FAIL("a request waits without a place"); };
  const auto response = ask("GET", address, {{"Prefer", "wait=60"}});
  CHECK(response.status == 200);
  CHECK(response.header("Preference-Applied").empty()); // it was not waited for
}
