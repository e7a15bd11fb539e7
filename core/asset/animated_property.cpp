#include "core/asset/animated_property.h"

#include <charconv>
#include <string_view>
#include <utility>
#include <vector>

namespace orbis::asset {
namespace {

constexpr std::string_view pointer_extension = "KHR_animation_pointer";

const std::string* pointer_of(const Json& channel) {
  const Json* pointer = find_path(channel, "target", "extensions", pointer_extension, "pointer");
  return pointer ? pointer->get_ptr<const std::string*>() : nullptr;
}

void set_pointer(Json& channel, std::string text) {
  channel["target"]["extensions"][std::string(pointer_extension)]["pointer"] = std::move(text);
}

// "/nodes/12/scale" is 12 and "scale" in "nodes".
struct Member {
  std::size_t number = 0;
  std::string rest;
};

std::optional<Member> member_of(std::string_view array, const std::string& pointer) {
  const std::string start = std::string("/").append(array).append("/");
  if (!pointer.starts_with(start)) return std::nullopt;
  Member out;
  const char *const first = pointer.data() + start.size(), *const last = pointer.data() + pointer.size();
  const auto [stop, error] = std::from_chars(first, last, out.number);
  if (error != std::errc{} || stop == last || *stop != '/') return std::nullopt;
  out.rest.assign(stop + 1, last);
  return out;
}

std::string pointer_to(std::string_view array, const Member& member) {
  return std::string("/")
      .append(array)
      .append("/")
      .append(std::to_string(member.number))
      .append("/")
      .append(member.rest);
}

bool resolves(const Json& document, const std::string& pointer) {
  try {
    return document.contains(Json::json_pointer(pointer));
  } catch (const Json::exception&) {
    return false; // not a pointer at all
  }
}

std::string parent_of(const std::string& pointer) { return pointer.substr(0, pointer.rfind('/')); }

// A property with a default need not be there: then what it is a property of has to be.
bool is_gone(const Json& before, const std::string& was, const Json& after, const std::string& now) {
  return (resolves(before, was) && !resolves(after, now)) ||
         (resolves(before, parent_of(was)) && !resolves(after, parent_of(now)));
}

template <class Visit> void for_animations(Json& document, Visit visit) {
  Json* animations = find(document, "animations");
  if (!animations || !animations->is_array()) return;
  for (Json& animation : *animations)
    if (Json* channels = find(animation, "channels"); channels && channels->is_array()) visit(*channels);
}

} // namespace

std::optional<AnimatedNode> animated_node(const Json& channel) {
  if (const std::string* pointer = pointer_of(channel)) {
    const std::optional<Member> member = member_of("nodes", *pointer);
    return member ? std::optional(AnimatedNode{member->number, member->rest}) : std::nullopt;
  }
  const Json *node = find_path(channel, "target", "node"), *path = find_path(channel, "target", "path");
  if (!node || !path || !path->is_string()) return std::nullopt;
  return AnimatedNode{node->get<std::size_t>(), path->get<std::string>()};
}

void set_animated_node(Json& channel, std::size_t node) {
  if (const std::string* pointer = pointer_of(channel)) {
    std::optional<Member> member = member_of("nodes", *pointer);
    if (!member) return;
    member->number = node;
    set_pointer(channel, pointer_to("nodes", *member));
    return;
  }
  channel["target"]["node"] = node;
}

void animate_copies(Json& document, std::string_view array, std::span<const PartCopy> copies) {
  for_animations(document, [&](Json& channels) {
    for (const auto& [of, copy] : copies) {
      Json added = Json::array();
      for (const Json& channel : channels) {
        const std::string* pointer = pointer_of(channel);
        std::optional<Member> member = pointer ? member_of(array, *pointer) : std::nullopt;
        if (!member || member->number != of) continue;
        member->number = copy;
        std::string text = pointer_to(array, *member);
        if (is_gone(document, *pointer, document, text)) continue;
        added.push_back(channel);
        set_pointer(added.back(), std::move(text));
      }
      for (Json& channel : added) channels.push_back(std::move(channel));
    }
  });
}

std::vector<std::string> drop_dead_channels(Json& document, const Json& before) {
  std::vector<std::string> dropped;
  for_animations(document, [&](Json& channels) {
    Json kept = Json::array();
    for (Json& channel : channels) {
      const std::string* pointer = pointer_of(channel);
      if (pointer && is_gone(before, *pointer, document, *pointer)) {
        dropped.push_back(*pointer);
      } else {
        kept.push_back(std::move(channel));
      }
    }
    channels = std::move(kept);
  });
  if (dropped.empty()) return dropped;
  Json kept = Json::array();
  for (Json& animation : document["animations"])
    if (array_size(animation, "channels") > 0) kept.push_back(std::move(animation));
  if (kept.empty()) {
    document.erase("animations");
  } else {
    document["animations"] = std::move(kept);
  }
  return dropped;
}

} // namespace orbis::asset
