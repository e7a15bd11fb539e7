// What HTTP says in headers.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace orbis::server {

// RFC 9110, section 5.6.7: "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string http_date(std::chrono::system_clock::time_point time);

// The value of a parameter of a Content-Disposition header, without its quotes; nothing where there is none. Quoted
// values may hold any character (RFC 9110, section 5.6.4), also those that end others. A backslash stands for itself,
// as browsers write it.
[[nodiscard]] std::optional<std::string> header_parameter(std::string_view header, std::string_view name);

} // namespace orbis::server
