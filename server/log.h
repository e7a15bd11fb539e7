// The log: one JSON object per line on standard error. It hears why; the client hears what.
#pragma once

#include <string_view>

#include "api/json.h"

namespace orbis::server {

enum class Level { info, warning, error };

// {"time":…,"level":…,"event":…, and the members of `fields`}. Thread-safe; a line is written whole.
void log_event(Level level, std::string_view event, const api::Json& fields = api::Json::object());

} // namespace orbis::server
