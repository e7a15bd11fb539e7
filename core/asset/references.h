// Every place of a glTF document that refers to another by number.
#pragma once

#include <functional>
#include <string_view>

#include "core/asset/json.h"

namespace orbis::asset {

enum class Kind { accessor, buffer_view, buffer, image, texture, sampler, material, mesh, node, skin, camera, scene };

// The top-level array that a reference of this kind counts in: "accessors", …
[[nodiscard]] std::string_view array_of(Kind kind);

// Visits the slots of the specification and of the extensions of references_are_known, in the order of the document.
// Parts of the wrong type are passed over; a slot itself may hold anything.
void for_each_reference(const Json& document, const std::function<void(Kind, const Json& slot)>& visit);
void for_each_reference(Json& document, const std::function<void(Kind, Json& slot)>& visit);

} // namespace orbis::asset
