#include <doctest/doctest.h>

#include <fstream>
#include <map>

#include "server/config.h"
#include "support/temporary_directory.h"

using namespace orbis;
using server::Config;

namespace {

server::Environment environment(std::map<std::string, std::string> values) {
  return [values = std::move(values)](const std::string& name) -> std::optional<std::string> {
    const auto it = values.find(name);
    return it == values.end() ? std::nullopt : std::optional(it->second);
  };
}

} // namespace

TEST_CASE("the service listens on loopback unless told otherwise") { CHECK(Config().http.host == "127.0.0.1"); }

TEST_CASE("every setting takes its own default back") {
  for (const auto& setting : server::settings()) {
    CAPTURE(setting.name);
    Config config;
    if (setting.name == "keys") continue; // a secret is not told
    CHECK_NOTHROW(server::set(config, setting.name, setting.get(config)));
    CHECK(setting.get(config) == setting.get(Config()));
  }
}

TEST_CASE("a setting has one name, spelled for the environment and the command line") {
  CHECK(server::environment_name("max_bytes") == "ORBIS_MAX_BYTES");
  CHECK(server::flag_name("max_bytes") == "--max-bytes");
}

TEST_CASE("the environment goes over the file") {
  const test::TemporaryDirectory directory;
  const auto file = directory.path / "orbis.json";
  std::ofstream(file) << R"({"port": 1000, "workers": 3, "host": "0.0.0.0"})";
  Config config;
  server::apply_file(config, file);
  server::apply_environment(config, environment({{"ORBIS_PORT", "2000"}}));
  CHECK(config.http.port == 2000);
  CHECK(config.scheduler.workers == 3);
  CHECK(config.http.host == "0.0.0.0");
}

TEST_CASE("bytes may have a unit, and the limit of the body is the job's too") {
  Config config;
  server::set(config, "max_bytes", "2M");
  CHECK(config.http.max_bytes == 2u << 20);
  CHECK(config.scheduler.limits.content.max_bytes == 2u << 20);
  server::set(config, "keys", "one,,two");
  CHECK(config.keys == std::vector<std::string>{"one", "two"});
}

TEST_CASE("what no setting takes is refused by name") {
  Config config;
  for (const auto& [name, value] : std::map<std::string, std::string>{{"port", "70000"},
                                                                      {"workers", "0"},
                                                                      {"queue", "many"},
                                                                      {"max_bytes", "1T"},
                                                                      {"ttl", "-1"},
                                                                      {"colour", "red"}}) {
    CAPTURE(name);
    try {
      server::set(config, name, value);
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_option);
      CHECK(error.where() == name);
    }
  }
}

TEST_CASE("a configuration file that is no JSON object is refused") {
  Config config;
  CHECK_THROWS_AS(server::apply_file(config, "/nonexistent/file.json"), Error);
}
