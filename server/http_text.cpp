#include "server/http_text.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>

#include "api/http.h"

namespace orbis::server {

std::string http_date(std::chrono::system_clock::time_point time) {
  const std::time_t now = std::chrono::system_clock::to_time_t(time);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 40> text{};
  // Not strftime: its names follow the locale.
  constexpr std::array<const char*, 7> days{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array<const char*, 12> months{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                               "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  std::snprintf(text.data(), text.size(), "%s, %02d %s %d %02d:%02d:%02d GMT",
                days.at(static_cast<std::size_t>(utc.tm_wday)), utc.tm_mday,
                months.at(static_cast<std::size_t>(utc.tm_mon)), utc.tm_year + 1900, utc.tm_hour, utc.tm_min,
                utc.tm_sec);
  return text.data();
}

std::optional<std::string> header_parameter(std::string_view header, std::string_view name) {
  std::size_t at = std::min(header.find(';'), header.size());
  while (at < header.size()) {
    at = std::min(header.find_first_not_of("; \t", at), header.size());
    const std::size_t equals = std::min(header.find_first_of("=;", at), header.size());
    const std::string_view found = header.substr(at, equals - at);
    if (equals == header.size() || header[equals] == ';') {
      at = equals;
      continue;
    }
    const bool is_quoted = equals + 1 < header.size() && header[equals + 1] == '"';
    const std::size_t first = equals + (is_quoted ? 2 : 1);
    const std::size_t end = std::min(header.find(is_quoted ? '"' : ';', first), header.size());
    if (api::equal_ignoring_case(found, name)) return std::string(header.substr(first, end - first));
    at = is_quoted ? std::min(end + 1, header.size()) : end;
  }
  return std::nullopt;
}

} // namespace orbis::server
