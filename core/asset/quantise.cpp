#include "core/asset/asset.h"

namespace orbis::asset {

void quantise_directions(NewPrimitive& primitive) {
  for (Attribute& attribute : primitive.attributes) {
    const bool is_direction = attribute.name == "NORMAL" || attribute.name == "TANGENT";
    if (!is_direction || attribute.type != ComponentType::f32) continue;
    Attribute small{attribute.name, ComponentType::i16, true, attribute.components, {}};
    small.data.resize(attribute.count() * attribute.components * size_of(small.type));
    for (std::size_t v = 0; v < attribute.count(); ++v)
      for (std::uint32_t c = 0; c < attribute.components; ++c) small.set(v, c, attribute.get(v, c));
    attribute = std::move(small);
  }
}

} // namespace orbis::asset
