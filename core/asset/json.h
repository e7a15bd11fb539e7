// JSON of untrusted origin: scanned before it is parsed, and read with an error that says where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/options.h"

namespace orbis::asset {

// Keeps the order of keys, so that what is not touched is written as it came.
using Json = nlohmann::ordered_json;

// Parses a glTF's JSON. A scan without recursion comes first: nesting above limits.max_json_depth, more than
// 2^23 values or 1024 keys in one object are refused before anything is built (an ordered object is searched from end
// to end). Throws Error{malformed, too_large}; the root is an object.
[[nodiscard]] Json parse_json(std::span<const std::byte> text, const Limits& limits);

// Reads members of an untrusted document. What has the wrong type throws Error{malformed} with its JSON pointer, which
// is searched for only then. A call for its check alone is fine: NOLINTBEGIN(modernize-use-nodiscard)
class JsonReader {
public:
  explicit JsonReader(const Json& root) : root_(root) {}

  // The member, or null where there is none. `parent` must be an object.
  const Json* member(const Json& parent, std::string_view key) const;
  // The same, where the member must be of the given type if it is there.
  const Json* object(const Json& parent, std::string_view key) const;
  const Json* array(const Json& parent, std::string_view key) const;
  const std::string* text(const Json& parent, std::string_view key) const;
  bool flag(const Json& parent, std::string_view key) const; // false where absent
  // An integer in [0, max].
  std::optional<std::uint64_t> integer(const Json& parent, std::string_view key, std::uint64_t max = max_integer) const;
  std::uint64_t required_integer(const Json& parent, std::string_view key, std::uint64_t max = max_integer) const;
  const Json& required_object(const Json& parent, std::string_view key) const;
  const std::string& required_text(const Json& parent, std::string_view key) const;

  // "/accessors/3/count" for a value of the document and one of its keys (or "" for the value itself).
  [[nodiscard]] std::string pointer(const Json& value, std::string_view key = {}) const;
  [[noreturn]] void fail(const Json& at, std::string_view key, const std::string& message,
                         ErrorCode code = ErrorCode::malformed) const;

  static constexpr std::uint64_t max_integer = 1ull << 53;

private:
  const Json& root_;
}; // NOLINTEND(modernize-use-nodiscard)

// The member of an object, or null where there is none or where `value` is no object: for what has been checked.
[[nodiscard]] const Json* find(const Json& value, std::string_view key);
[[nodiscard]] Json* find(Json& value, std::string_view key);
// find along a path of keys.
template <class J, class... Keys> [[nodiscard]] J* find_path(J& value, std::string_view key, Keys... keys) {
  J* found = find(value, key);
  if constexpr (sizeof...(keys) == 0) {
    return found;
  } else {
    return found ? find_path(*found, keys...) : nullptr;
  }
}
// value[key], with the size of an array there (0 where there is none).
[[nodiscard]] std::size_t array_size(const Json& value, std::string_view key);

} // namespace orbis::asset
