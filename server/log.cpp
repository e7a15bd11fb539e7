#include "server/log.h"

#include <unistd.h>

#include <array>

namespace orbis::server {

void log_event(Level level, std::string_view event, const api::Json& fields) {
  constexpr std::array<std::string_view, 3> names{"info", "warning", "error"};
  api::Json line{
      {"time", api::rfc3339(api::now())}, {"level", names.at(static_cast<std::size_t>(level))}, {"event", event}};
  line.update(fields);
  const std::string text = api::dump(line) + "\n";
  // One write: lines of several threads do not mix. Where standard error is gone there is nobody to tell.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

} // namespace orbis::server
