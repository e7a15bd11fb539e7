// What an animation's channel moves, whether it names a node or, by KHR_animation_pointer, any property.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/json.h"

namespace orbis::asset {

struct AnimatedNode {
  std::size_t node = 0;
  std::string property; // "translation", "rotation", "scale", "weights", or what an extension adds
};

// Nothing where the channel animates something else.
[[nodiscard]] std::optional<AnimatedNode> animated_node(const Json& channel);

// Makes the channel, which animates a node, animate the same property of another one.
void set_animated_node(Json& channel, std::size_t node);

// A material or a mesh that was copied, and its copy.
struct PartCopy {
  std::size_t of = 0, copy = 0;
};

// What animates a part of the document by pointer animates its copies alike. array: "materials" or "meshes". copies: a
// copy's own copies stand behind it.
void animate_copies(Json& document, std::string_view array, std::span<const PartCopy> copies);

// Drops the channels whose pointer led to something in `before` that is gone: a texture transform, which the atlas has
// no use for. Animations without a channel go too. Returns the pointers that were dropped.
std::vector<std::string> drop_dead_channels(Json& document, const Json& before);

} // namespace orbis::asset
