// Identifiers, digests, connections, estimates.
#include <doctest/doctest.h>
#include <sys/socket.h>

#include <algorithm>
#include <vector>

#include "server/connections.h"
#include "server/file_descriptor.h"
#include "server/http_text.h"
#include "server/sha256.h"
#include "server/time_to_go.h"
#include "server/ulid.h"

using namespace orbis;
using namespace orbis::server;

TEST_CASE("identifiers grow strictly, also within a millisecond and when the clock goes back") {
  UlidSource source;
  const api::Time time = api::now();
  std::vector<std::string> ids;
  for (int i = 0; i < 1000; ++i) ids.push_back(source.next(time));
  ids.push_back(source.next(time - std::chrono::hours(1)));
  ids.push_back(source.next(time + std::chrono::hours(1)));
  CHECK(std::ranges::adjacent_find(ids, std::greater_equal<>()) == ids.end());
  for (const std::string& id : ids) {
    CHECK(id.size() == 26);
    CHECK(id.find_first_not_of("0123456789ABCDEFGHJKMNPQRSTVWXYZ") == std::string::npos);
  }
}

TEST_CASE("the time of an identifier is in its first ten digits") {
  UlidSource source;
  CHECK(source.next(api::Time(std::chrono::milliseconds(1'469'918'176'385))).substr(0, 10) == "01ARYZ6S41");
}

TEST_CASE("SHA-256 of the standard's example, whole and in pieces") {
  const std::string expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  CHECK(sha256_of("abc") == expected);
  Sha256 hash;
  for (const char c : std::string("abc")) hash.update(std::as_bytes(std::span(&c, 1)));
  CHECK(hash.finish() == expected);
}

TEST_CASE("the connection that is longest without work makes room; those we work for stay") {
  int first[2], second[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, first) == 0);
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, second) == 0);
  const FileDescriptor a(first[0]), far_a(first[1]), b(second[0]), far_b(second[1]);
  const auto is_open = [](const FileDescriptor& far) {
    char byte = 0;
    return ::recv(far.get(), &byte, 1, MSG_DONTWAIT) < 0; // an end of stream would be 0
  };
  Connections connections(2);
  for (int i = 0; i < 3; ++i) connections.accepted();
  connections.set_working(connections.open(a.get()), true);
  (void)connections.open(b.get());
  const auto now = Connections::Clock::now();
  connections.make_room(now - Connections::grace); // too soon to call anyone slow
  CHECK(is_open(far_a));
  CHECK(is_open(far_b));
  connections.make_room(now + Connections::grace); // one still waits
  CHECK(is_open(far_a));
  CHECK_FALSE(is_open(far_b));
}

TEST_CASE("the time to go is learnt from the jobs before") {
  TimeToGoModel model;
  Milestones half_way;
  half_way.reach(50, 100);
  CHECK_FALSE(model.estimate(half_way, 100).has_value());
  for (const double wall : {200.0, 200.0, 200.0, 200.0, 500.0}) model.learn(half_way, wall);
  const auto estimate = model.estimate(half_way, 120);
  REQUIRE(estimate.has_value());
  CHECK(estimate->p50 == doctest::Approx(80));
  CHECK(estimate->p90 == doctest::Approx(380));
  CHECK(model.estimate(half_way, 10'000)->p90 == 0);
}

TEST_CASE("dates of HTTP are in English and in GMT") {
  CHECK(http_date(std::chrono::system_clock::from_time_t(784111777)) == "Sun, 06 Nov 1994 08:49:37 GMT");
}

TEST_CASE("parameters of a header are found whatever the quoted ones hold") {
  const char* const header = "form-data; NAME=file; filename=\"a;b=1 name=x.bin\"; empty=\"\"; flag";
  CHECK(header_parameter(header, "name") == "file");
  CHECK(header_parameter(header, "filename") == "a;b=1 name=x.bin");
  CHECK(header_parameter(header, "empty") == "");
  CHECK_FALSE(header_parameter(header, "flag").has_value());
  CHECK_FALSE(header_parameter(header, "b").has_value());
  CHECK(header_parameter("form-data; filename=\"cut off", "filename") == "cut off");
  CHECK_FALSE(header_parameter("form-data", "name").has_value());
  CHECK_FALSE(header_parameter("", "name").has_value());
}
