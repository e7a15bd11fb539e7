#include "core/asset/json.h"

#include <utility>
#include <vector>

namespace orbis::asset {
namespace {

constexpr std::uint64_t max_values = 1ull << 23;
constexpr std::uint32_t max_keys = 1024;

// Counts what the parser would build. Strings are skipped; whether the text is JSON at all is the parser's business.
void scan(std::span<const std::byte> text, const Limits& limits) {
  std::vector<std::uint32_t> members; // of each open array (not counted: 0) or object
  std::uint64_t values = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(text[i]);
    if (c == '"') {
      for (++i; i < text.size() && static_cast<char>(text[i]) != '"'; ++i) {
        if (static_cast<char>(text[i]) == '\\') ++i;
      }
    } else if (c == '[' || c == '{') {
      members.push_back(0);
      ++values;
      if (members.size() > limits.max_json_depth) {
        throw Error(ErrorCode::too_large,
                    "the JSON is nested deeper than the limit of " + std::to_string(limits.max_json_depth) + " levels");
      }
    } else if (c == ']' || c == '}') {
      if (!members.empty()) members.pop_back();
    } else if (c == ',') {
      ++values;
    } else if (c == ':' && !members.empty() && ++members.back() > max_keys) {
      throw Error(ErrorCode::too_large,
                  "an object of the JSON has more than the limit of " + std::to_string(max_keys) + " keys");
    }
    if (values > max_values) {
      throw Error(ErrorCode::too_large,
                  "the JSON has more than the limit of " + std::to_string(max_values) + " values");
    }
  }
}

// The parser's own message names its internals; people are helped by the place.
Json parse(std::span<const std::byte> text) {
  const auto* first = reinterpret_cast<const char*>(text.data());
  try {
    return Json::parse(first, first + text.size());
  } catch (const Json::parse_error& error) {
    throw Error(ErrorCode::malformed, "the JSON has a syntax error at byte " + std::to_string(error.byte));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::malformed, "the JSON has a number that is out of range");
  }
}

std::string escaped(std::string_view key) {
  std::string out;
  for (const char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

// Depth-first, by address. The nesting is bounded by Limits::max_json_depth.
bool path_to(const Json& from, const Json& target, std::string& path) {
  if (&from == &target) return true;
  const std::size_t length = path.size();
  std::size_t index = 0;
  if (from.is_array()) {
    for (const Json& item : from) {
      path.append(1, '/').append(std::to_string(index++));
      if (path_to(item, target, path)) return true;
      path.resize(length);
    }
  } else if (from.is_object()) {
    for (const auto& [key, item] : from.get_ref<const Json::object_t&>()) {
      path.append(1, '/').append(escaped(key));
      if (path_to(item, target, path)) return true;
      path.resize(length);
    }
  }
  return false;
}

} // namespace

Json parse_json(std::span<const std::byte> text, const Limits& limits) {
  scan(text, limits);
  Json json = parse(text);
  if (!json.is_object()) throw Error(ErrorCode::malformed, "the JSON is not an object, so it is no glTF");
  return json;
}

std::string JsonReader::pointer(const Json& value, std::string_view key) const {
  std::string path;
  path_to(root_, value, path);
  if (!key.empty()) path.append(1, '/').append(escaped(key));
  return path;
}

void JsonReader::fail(const Json& at, std::string_view key, const std::string& message, ErrorCode code) const {
  const std::string where = pointer(at, key);
  throw Error(code, (where.empty() ? "the document" : where) + " " + message, where);
}

const Json* JsonReader::member(const Json& parent, std::string_view key) const {
  if (!parent.is_object()) fail(parent, {}, "must be an object");
  return find(parent, key);
}

const Json* JsonReader::object(const Json& parent, std::string_view key) const {
  const Json* found = member(parent, key);
  if (found && !found->is_object()) fail(parent, key, "must be an object");
  return found;
}

const Json* JsonReader::array(const Json& parent, std::string_view key) const {
  const Json* found = member(parent, key);
  if (found && !found->is_array()) fail(parent, key, "must be an array");
  return found;
}

const std::string* JsonReader::text(const Json& parent, std::string_view key) const {
  const Json* found = member(parent, key);
  if (found && !found->is_string()) fail(parent, key, "must be a string");
  return found ? found->get_ptr<const std::string*>() : nullptr;
}

bool JsonReader::flag(const Json& parent, std::string_view key) const {
  const Json* found = member(parent, key);
  if (found && !found->is_boolean()) fail(parent, key, "must be true or false");
  return found && found->get<bool>();
}

std::optional<std::uint64_t> JsonReader::integer(const Json& parent, std::string_view key, std::uint64_t max) const {
  const Json* found = member(parent, key);
  if (!found) return std::nullopt;
  if (!found->is_number_unsigned()) fail(parent, key, "must be a whole number that is not negative");
  const auto value = found->get<std::uint64_t>();
  if (value > max)
    fail(parent, key, "is " + std::to_string(value) + ", the most that is allowed is " + std::to_string(max));
  return value;
}

std::uint64_t JsonReader::required_integer(const Json& parent, std::string_view key, std::uint64_t max) const {
  const auto value = integer(parent, key, max);
  if (!value) fail(parent, key, "is missing");
  return *value;
}

const Json& JsonReader::required_object(const Json& parent, std::string_view key) const {
  const Json* found = object(parent, key);
  if (!found) fail(parent, key, "is missing");
  return *found;
}

const std::string& JsonReader::required_text(const Json& parent, std::string_view key) const {
  const std::string* found = text(parent, key);
  if (!found) fail(parent, key, "is missing");
  return *found;
}

const Json* find(const Json& value, std::string_view key) {
  if (!value.is_object()) return nullptr;
  for (const auto& [name, item] : value.get_ref<const Json::object_t&>()) {
    if (name == key) return &item;
  }
  return nullptr;
}

Json* find(Json& value, std::string_view key) { return const_cast<Json*>(find(std::as_const(value), key)); }

std::size_t array_size(const Json& value, std::string_view key) {
  const Json* found = find(value, key);
  return found && found->is_array() ? found->size() : 0;
}

} // namespace orbis::asset
