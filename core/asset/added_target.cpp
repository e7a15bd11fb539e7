#include "core/asset/added_target.h"

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/asset/accessor_reader.h"

namespace orbis::asset {
namespace {

class TargetAdder {
public:
  TargetAdder(Output& out, const Asset& asset) : out_(out), document_(*asset.document) {}

  void add(std::size_t mesh, const std::string& name) {
    const std::size_t before = targets_of(document_.json["meshes"][mesh]["primitives"][0]);
    before_[mesh] = before;
    const std::size_t count = out_.json["meshes"][mesh]["primitives"].size();
    for (std::size_t p = 0; p < count; ++p) {
      if (targets_of(out_.json["meshes"][mesh]["primitives"][p]) == before) add_standstill(mesh, p);
    }
    Json& json = out_.json["meshes"][mesh];
    Json weights = json.value("weights", Json::array());
    while (weights.size() <= before) weights.push_back(0);
    json["weights"] = std::move(weights);
    add_name(json, before, name);
  }

  void extend_nodes_and_animations() {
    if (before_.empty()) return;
    if (Json* nodes = find(out_.json, "nodes")) {
      for (Json& node : *nodes) {
        Json* weights = find(node, "weights");
        const Json* mesh = find(node, "mesh");
        if (weights && weights->is_array() && mesh && old_targets(mesh->get<std::size_t>())) weights->push_back(0);
      }
    }
    const std::size_t animations = array_size(out_.json, "animations");
    for (std::size_t a = 0; a < animations; ++a) extend_animation(a);
  }

private:
  static std::size_t targets_of(const Json& primitive) { return array_size(primitive, "targets"); }

  // How many targets the mesh had, if one was added to it.
  [[nodiscard]] std::optional<std::size_t> old_targets(std::size_t mesh) const {
    const auto found = before_.find(mesh);
    return found == before_.end() ? std::nullopt : std::optional(found->second);
  }

  // Differences that are all zero: an accessor without data.
  void add_standstill(std::size_t mesh, std::size_t p) {
    const Json* position = find_path(out_.json["meshes"][mesh]["primitives"][p], "attributes", "POSITION");
    if (!position) return;
    const Json count = out_.json["accessors"][position->get<std::size_t>()]["count"];
    const Json zero = Json::array({0, 0, 0});
    const std::size_t accessor = out_.add_accessor(
        Json{{"componentType", 5126}, {"count", count}, {"type", "VEC3"}, {"min", zero}, {"max", zero}});
    Json& targets = out_.json["meshes"][mesh]["primitives"][p]["targets"];
    if (!targets.is_array()) targets = Json::array();
    targets.push_back(Json{{"POSITION", accessor}});
  }

  static void add_name(Json& mesh, std::size_t before, const std::string& name) {
    Json& extras = mesh["extras"];
    // Extras that are no object can take no member: they become one.
    if (!extras.is_object()) extras = extras.is_null() ? Json::object() : Json{{"input", extras}};
    Json names = extras.value("targetNames", Json::array());
    if (!names.is_array() || names.size() > before) names = Json::array();
    while (names.size() < before) names.push_back(std::to_string(names.size()));
    names.push_back(name);
    extras["targetNames"] = std::move(names);
  }

  // The number behind "/nodes/" in "/nodes/3/weights".
  static std::optional<std::size_t> number_in(const std::string& pointer, const std::string& array) {
    const std::string start = "/" + array + "/", end = "/weights";
    if (!pointer.starts_with(start) || !pointer.ends_with(end) || pointer.size() <= start.size() + end.size())
      return std::nullopt;
    std::size_t number = 0;
    const char *first = pointer.data() + start.size(), *last = pointer.data() + pointer.size() - end.size();
    const auto [stop, error] = std::from_chars(first, last, number);
    return error == std::errc{} && stop == last ? std::optional(number) : std::nullopt;
  }

  [[nodiscard]] std::optional<std::size_t> old_targets_of_node(std::size_t node) const {
    if (node >= array_size(out_.json, "nodes")) return std::nullopt;
    const Json* mesh = find(out_.json["nodes"][node], "mesh");
    return mesh ? old_targets(mesh->get<std::size_t>()) : std::nullopt;
  }

  // How many weights a channel animates, if one was added to them.
  [[nodiscard]] std::optional<std::size_t> animated_targets(const Json& channel) const {
    const Json* path = find_path(channel, "target", "path");
    if (const Json* node = find_path(channel, "target", "node"); path && node && *path == "weights")
      return old_targets_of_node(node->get<std::size_t>());
    const Json* pointer = find_path(channel, "target", "extensions", "KHR_animation_pointer", "pointer");
    if (!pointer || !pointer->is_string()) return std::nullopt;
    const auto text = pointer->get<std::string>();
    if (const auto node = number_in(text, "nodes")) return old_targets_of_node(*node);
    const auto mesh = number_in(text, "meshes");
    return mesh ? old_targets(*mesh) : std::nullopt;
  }

  // Each such channel gets a sampler of its own, since others may share the old one.
  void extend_animation(std::size_t a) {
    const std::size_t channels = array_size(out_.json["animations"][a], "channels");
    for (std::size_t c = 0; c < channels; ++c) {
      const Json channel = out_.json["animations"][a]["channels"][c];
      const auto targets = animated_targets(channel);
      const Json* number = find(channel, "sampler");
      if (!targets || *targets == 0 || !number) continue;
      Json sampler = out_.json["animations"][a]["samplers"][number->get<std::size_t>()];
      const std::optional<std::size_t> output = extended(sampler["output"].get<std::size_t>(), *targets);
      if (!output) continue;
      sampler["output"] = *output;
      Json& samplers = out_.json["animations"][a]["samplers"];
      out_.json["animations"][a]["channels"][c]["sampler"] = samplers.size();
      samplers.push_back(std::move(sampler));
    }
  }

  // The animated weights with a zero behind every `targets` of them; for cubic splines that holds for their tangents
  // too. Nothing where their number does not fit.
  std::optional<std::size_t> extended(std::size_t accessor, std::size_t targets) {
    if (const auto known = extended_.find({accessor, targets}); known != extended_.end()) return known->second;
    if (!model_) model_.emplace(typed_model(document_.json));
    const Attribute before = AccessorReader(document_, *model_).attribute(accessor, "weights");
    if (before.components != 1 || before.count() % targets != 0) return std::nullopt;
    Attribute after{"weights", before.type, before.normalized, 1, {}};
    after.data.resize(before.data.size() / targets * (targets + 1));
    for (std::size_t i = 0; i < before.count(); ++i)
      after.set(i / targets * (targets + 1) + i % targets, 0, before.get(i, 0));
    Json json = accessor_of(after);
    json["bufferView"] = out_.add_view(after.data);
    return extended_[{accessor, targets}] = out_.add_accessor(std::move(json));
  }

  Output& out_;
  const Document& document_;
  std::optional<tinygltf::Model> model_;
  std::map<std::size_t, std::size_t> before_;                           // mesh -> targets that it had
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> extended_; // accessor, targets -> longer accessor
};

} // namespace

void describe_added_targets(Output& out, const Asset& asset, std::span<const NewPrimitive> primitives) {
  TargetAdder adder(out, asset);
  std::set<std::size_t> done;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (primitives[i].added_target.empty() || !done.insert(asset.primitives[i].mesh).second) continue;
    adder.add(asset.primitives[i].mesh, primitives[i].added_target);
  }
  adder.extend_nodes_and_animations();
}

} // namespace orbis::asset
