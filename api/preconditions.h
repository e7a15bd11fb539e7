// The parts of RFC 9110 and RFC 7240 that the contract uses: entity tags, one byte range, preferences.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace orbis::api {

// Does a list as in If-None-Match ("*", or tags with or without W/) hold this strong tag (with its quotes)?
[[nodiscard]] bool matches_etag(std::string_view list, std::string_view etag);

// A strong tag made from the bytes of a representation.
[[nodiscard]] std::string etag_of(std::string_view representation);

struct ByteRange {
  std::uint64_t offset = 0, length = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

enum class RangeKind {
  whole, // no Range, or one that RFC 9110 says to ignore: another unit, bad syntax, several ranges
  part,
  unsatisfiable, // begins after the end
};

struct RangeRequest {
  RangeKind kind = RangeKind::whole;
  ByteRange range;
};

// A Range header against a representation of `size` bytes.
[[nodiscard]] RangeRequest parse_range(std::string_view header, std::uint64_t size);

// wait=N of a Prefer header in seconds; nothing where it is absent or not a number.
[[nodiscard]] std::optional<std::chrono::seconds> preferred_wait(std::string_view header);

} // namespace orbis::api
