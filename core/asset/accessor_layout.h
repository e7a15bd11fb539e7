// Sizes of accessor elements (glTF 2.0, section 3.6.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/asset/asset.h"

namespace orbis::asset {

// "SCALAR", "VEC3", "MAT4", … as columns x rows; vectors are one column.
struct ElementShape {
  std::size_t columns = 1, rows = 1;
};
[[nodiscard]] std::optional<ElementShape> shape_of(std::string_view type);
[[nodiscard]] std::string_view vector_type(std::size_t components); // 1 to 4 -> "SCALAR" … "VEC4"

[[nodiscard]] bool is_component_type(std::uint64_t code);

// Bytes of one element; the columns of matrices start at multiples of 4.
[[nodiscard]] std::size_t element_size(ComponentType type, ElementShape shape);

} // namespace orbis::asset
