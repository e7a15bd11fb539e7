// What was repaired, told in words.
#pragma once

#include <cstdint>

#include "core/report.h"

namespace orbis {

// One note for each kind of repair that report.repairs counts, and for what is odd about the input.
void note_repairs(std::uint64_t unused_vertices, Report& report);

} // namespace orbis
