// The checks that make a glTF document safe to read: run before any other part looks at it.
#pragma once

#include "core/asset/json.h"

namespace orbis::asset {

// Checks the version, the required extensions, that the known arrays hold objects, that every reference is in range,
// that buffer views lie in their buffers and accessors in their views (sizes computed without overflow), types and
// strides. Does not look at buffers' contents. Throws Error: malformed, unsupported_format (another version),
// unsupported_feature (a required extension), too_large (accessors without a view beyond the limits).
void check_document(const Json& document, const Limits& limits);

// Checks nodes: no cycle, one parent each, at most 2,000 levels. Then, where every node that shows a mesh scales it to
// nothing (its world matrix has rank 0 or 1, so that no triangle has area) and no animation changes that, throws
// Error{invalid_geometry}. Expects check_document to have passed.
void check_nodes(const Json& document);

} // namespace orbis::asset
