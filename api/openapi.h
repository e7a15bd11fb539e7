// The contract's one definition, api/openapi.yaml, as JSON; made at build time.
#pragma once

#include <string_view>

namespace orbis::api {

extern const std::string_view openapi_json;

} // namespace orbis::api
