#include <doctest/doctest.h>

#include "api/preconditions.h"

using namespace orbis::api;

namespace {

void check_part(std::string_view header, std::uint64_t size, std::uint64_t offset, std::uint64_t length) {
  CAPTURE(header);
  const RangeRequest range = parse_range(header, size);
  REQUIRE(range.kind == RangeKind::part);
  CHECK(range.range == ByteRange{offset, length});
}

} // namespace

TEST_CASE("one range of bytes is understood in its three forms") {
  check_part("bytes=0-9", 100, 0, 10);
  check_part("bytes=90-", 100, 90, 10);
  check_part("bytes=-5", 100, 95, 5);
  check_part("bytes=95-200", 100, 95, 5);
  check_part("bytes=-500", 100, 0, 100);
}

TEST_CASE("what is no single range of bytes gives the whole file") {
  for (const char* header : {"", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-2", "lines=1-2", "bytes=0-1,5-6", "bytes=1",
                             "bytes=99999999999999999999-"}) {
    CAPTURE(header);
    CHECK(parse_range(header, 100).kind == RangeKind::whole);
  }
}

TEST_CASE("a range that begins after the end cannot be satisfied") {
  CHECK(parse_range("bytes=100-", 100).kind == RangeKind::unsatisfiable);
  CHECK(parse_range("bytes=-0", 100).kind == RangeKind::unsatisfiable);
  CHECK(parse_range("bytes=-1", 0).kind == RangeKind::unsatisfiable);
}

TEST_CASE("entity tags are found in lists, weak or strong") {
  CHECK(matches_etag(R"("a")", R"("a")"));
  CHECK(matches_etag(R"("b", W/"a")", R"("a")"));
  CHECK(matches_etag("*", R"("a")"));
  CHECK_FALSE(matches_etag("", R"("a")"));
  CHECK_FALSE(matches_etag(R"("b")", R"("a")"));
  CHECK_FALSE(matches_etag("a", R"("a")"));
}

TEST_CASE("different documents have different tags, the same one the same") {
  CHECK(etag_of("one") == etag_of("one"));
  CHECK(etag_of("one") != etag_of("two"));
}

TEST_CASE("the time to wait is found among preferences") {
  using std::chrono::seconds;
  CHECK(preferred_wait("wait=30") == seconds(30));
  CHECK(preferred_wait("respond-async, WAIT=5; x=y") == seconds(5));
  CHECK(preferred_wait("wait = 7") == seconds(7));
  CHECK_FALSE(preferred_wait("").has_value());
  CHECK_FALSE(preferred_wait("wait").has_value());
  CHECK_FALSE(preferred_wait("wait=soon").has_value());
  CHECK_FALSE(preferred_wait("wait=-1").has_value());
}
