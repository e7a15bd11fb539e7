#include "api/preconditions.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "api/http.h"

namespace orbis::api {
namespace {

std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Takes the next element of a list separated by `separator`, without the spaces around it.
std::string_view next_element(std::string_view& list, char separator) {
  const auto end = std::min(list.find(separator), list.size());
  const std::string_view element = trim(list.substr(0, end));
  list.remove_prefix(std::min(end + 1, list.size()));
  return element;
}

} // namespace

bool matches_etag(std::string_view list, std::string_view etag) {
  while (!list.empty()) {
    std::string_view element = next_element(list, ',');
    if (element == "*") return true;
    if (element.starts_with("W/")) element.remove_prefix(2);
    if (element == etag) return true;
  }
  return false;
}

std::string etag_of(std::string_view representation) {
  // FNV-1a, 64 bits: tells versions of one small document apart, proves nothing.
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : representation) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "\"%016llx\"", static_cast<unsigned long long>(hash));
  return text.data();
}

RangeRequest parse_range(std::string_view header, std::uint64_t size) {
  constexpr std::string_view unit = "bytes=";
  if (!header.starts_with(unit)) return {};
  const std::string_view spec = trim(header.substr(unit.size()));
  const auto dash = spec.find('-');
  if (dash == std::string_view::npos || spec.find(',') != std::string_view::npos) return {};
  const auto first = parse_number(spec.substr(0, dash)), last = parse_number(spec.substr(dash + 1));
  if (dash == 0) { // the last N bytes
    if (!last) return {};
    if (*last == 0 || size == 0) return {RangeKind::unsatisfiable, {}};
    const std::uint64_t length = std::min(*last, size);
    return {RangeKind::part, {size - length, length}};
  }
  const bool open = dash + 1 == spec.size();
  if (!first || (!open && (!last || *last < *first))) return {};
  if (*first >= size) return {RangeKind::unsatisfiable, {}};
  const std::uint64_t end = open ? size : std::min(*last, size - 1) + 1;
  return {RangeKind::part, {*first, end - *first}};
}

std::optional<std::chrono::seconds> preferred_wait(std::string_view header) {
  while (!header.empty()) {
    std::string_view preference = next_element(header, ',');
    preference = next_element(preference, ';'); // parameters of a preference do not matter here
    const std::string_view name = next_element(preference, '=');
    if (!equal_ignoring_case(name, "wait")) continue;
    if (const auto seconds = parse_number(trim(preference))) {
      return std::chrono::seconds(std::min<std::uint64_t>(*seconds, 86'400));
    }
  }
  return std::nullopt;
}

} // namespace orbis::api
