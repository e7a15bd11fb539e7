#include "core/asset/accessor_layout.h"

#include <array>
#include <utility>

namespace orbis::asset {

std::optional<ElementShape> shape_of(std::string_view type) {
  static constexpr std::array<std::pair<std::string_view, ElementShape>, 7> shapes{{{"SCALAR", {1, 1}},
                                                                                    {"VEC2", {1, 2}},
                                                                                    {"VEC3", {1, 3}},
                                                                                    {"VEC4", {1, 4}},
                                                                                    {"MAT2", {2, 2}},
                                                                                    {"MAT3", {3, 3}},
                                                                                    {"MAT4", {4, 4}}}};
  for (const auto& [name, shape] : shapes) {
    if (name == type) return shape;
  }
  return std::nullopt;
}

std::string_view vector_type(std::size_t components) {
  static constexpr std::array<std::string_view, 4> names{"SCALAR", "VEC2", "VEC3", "VEC4"};
  return names.at(components - 1);
}

bool is_component_type(std::uint64_t code) { return code >= 5120 && code <= 5126 && code != 5124; }

std::size_t size_of(ComponentType type) {
  switch (type) {
  case ComponentType::i8:
  case ComponentType::u8:
    return 1;
  case ComponentType::i16:
  case ComponentType::u16:
    return 2;
  case ComponentType::u32:
  case ComponentType::f32:
    return 4;
  }
  return 0;
}

std::size_t element_size(ComponentType type, ElementShape shape) {
  const std::size_t column = shape.rows * size_of(type);
  return shape.columns == 1 ? column : shape.columns * ((column + 3) / 4 * 4);
}

} // namespace orbis::asset
