// What the report says of the input, and what the result's file says of itself.
#pragma once

#include <string>

#include "core/asset/asset.h"
#include "core/report.h"

namespace orbis {

// The format and the reader's notes.
void describe_input(const asset::Asset& asset, Report& report);

// The JSON object of asset.extras.orbis: version, options, measures and what is certified. Holds nothing that differs
// from run to run, so the same input gives the same bytes.
[[nodiscard]] std::string extras_of(const Report& report);

} // namespace orbis
