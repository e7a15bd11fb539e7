#include "core/asset/levels.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/asset/animated_property.h"
#include "core/asset/extensions.h"

namespace orbis::asset {
namespace {

constexpr std::string_view instancing_extension = "EXT_mesh_gpu_instancing";

// Mesh of the document -> its meshes on the levels.
using LevelMeshes = std::map<std::size_t, std::vector<std::size_t>>;

std::string level_name(const Json& named, std::size_t level) {
  const Json* name = find(named, "name");
  const std::string base = name && name->is_string() ? name->get<std::string>() : "";
  return base + (base.empty() ? "LOD" : "_LOD") + std::to_string(level + 1);
}

// Primitive of a mesh -> primitive of the asset; those that have new geometry.
using Replaced = std::map<std::size_t, std::size_t>;

// By mesh of the document.
std::map<std::size_t, Replaced> replaced_primitives(const Asset& asset, std::span<const NewPrimitive> full) {
  std::map<std::size_t, Replaced> out;
  for (std::size_t i = 0; i < full.size(); ++i)
    if (!full[i].indices.empty()) out[asset.primitives[i].mesh][asset.primitives[i].primitive] = i;
  return out;
}

// The mesh with the level's primitives in place of the full ones; null where none is left.
Json level_mesh(const Json& mesh, const Replaced& replaced, const NewLevel& level, const WritePrimitive& write) {
  Json primitives = Json::array();
  bool any = false;
  for (std::size_t p = 0; p < mesh["primitives"].size(); ++p) {
    const auto i = replaced.find(p);
    if (i == replaced.end()) {
      primitives.push_back(mesh["primitives"][p]);
    } else if (!level.primitives[i->second].indices.empty()) {
      primitives.push_back(write(mesh["primitives"][p], level.primitives[i->second]));
      any = true;
    }
  }
  if (!any) return nullptr;
  Json out = mesh;
  out["primitives"] = std::move(primitives);
  return out;
}

LevelMeshes add_meshes(Output& out, const Asset& asset, std::span<const NewPrimitive> full,
                       std::span<const NewLevel> levels, const WritePrimitive& write) {
  const std::map<std::size_t, Replaced> changed = replaced_primitives(asset, full);
  LevelMeshes meshes;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (const auto& [m, replaced] : changed) {
      // A copy, since what write() adds may move the document's parts.
      const Json base = out.json["meshes"][m];
      Json mesh = level_mesh(base, replaced, levels[level], write);
      if (mesh.is_null()) {
        meshes[m].push_back(level == 0 ? m : meshes[m].back());
        continue;
      }
      mesh["name"] = level_name(base, level);
      meshes[m].push_back(out.json["meshes"].size());
      out.json["meshes"].push_back(std::move(mesh));
    }
  }
  return meshes;
}

// Nodes that something else refers to by number: joints, and what animations move.
struct NodeUse {
  std::set<std::size_t> moved_or_joint;
  std::set<std::size_t> own_levels; // of the input: nodes that have the extension, and their levels
};

NodeUse use_of(const Json& json) {
  NodeUse use;
  for (const Json& animation : json.value("animations", Json::array())) {
    for (const Json& channel : animation.value("channels", Json::array())) {
      const std::optional<AnimatedNode> animated = animated_node(channel);
      if (animated && !animated->property.starts_with("weights")) use.moved_or_joint.insert(animated->node);
    }
  }
  for (const Json& skin : json.value("skins", Json::array()))
    for (const Json& joint : skin.value("joints", Json::array())) use.moved_or_joint.insert(joint.get<std::size_t>());
  const Json nodes = json.value("nodes", Json::array());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Json* ids = find_path(nodes[n], "extensions", lod_extension, "ids");
    if (!ids || !ids->is_array()) continue;
    use.own_levels.insert(n);
    for (const Json& id : *ids) use.own_levels.insert(id.get<std::size_t>());
  }
  return use;
}

// Whether a node may be replaced as a whole, since it has nothing but its mesh and its place.
bool is_plain(const Json& node) {
  if (node.contains("children") || node.contains("camera")) return false;
  const Json* extensions = find(node, "extensions");
  return !extensions || std::all_of(extensions->begin(), extensions->end(),
                                    [&](const Json& e) { return &e == find(*extensions, instancing_extension); });
}

class LevelNodes {
public:
  LevelNodes(Json& json, const LevelMeshes& meshes, std::span<const NewLevel> levels)
      : json_(json), meshes_(meshes), levels_(levels), use_(use_of(json)) {}

  void run() {
    const std::size_t count = array_size(json_, "nodes");
    for (std::size_t n = 0; n < count; ++n) {
      const Json* mesh = find(json_["nodes"][n], "mesh");
      const auto found = mesh ? meshes_.find(mesh->get<std::size_t>()) : meshes_.end();
      if (found == meshes_.end() || use_.own_levels.contains(n)) continue;
      const bool stays = is_plain(json_["nodes"][n]) && !use_.moved_or_joint.contains(n);
      add_levels_of(stays ? n : mesh_holder(n), found->second);
    }
    for (Json& animation : animations()) add_channels(animation);
  }

private:
  Json& animations() {
    static Json none = Json::array();
    Json* found = find(json_, "animations");
    return found ? *found : none;
  }

  std::size_t append(Json node) {
    json_["nodes"].push_back(std::move(node));
    return json_["nodes"].size() - 1;
  }

  // Moves the mesh, and what goes with it, to a child without a transform.
  std::size_t mesh_holder(std::size_t n) {
    Json node = json_["nodes"][n], holder = Json::object();
    if (const Json* name = find(node, "name")) holder["name"] = *name;
    for (const char* key : {"mesh", "skin", "weights"}) {
      if (!node.contains(key)) continue;
      holder[key] = node[key];
      node.erase(key);
    }
    if (const Json* instancing = find_path(node, "extensions", instancing_extension)) {
      holder["extensions"][std::string(instancing_extension)] = *instancing;
      node["extensions"].erase(std::string(instancing_extension));
      if (node["extensions"].empty()) node.erase("extensions");
    }
    const std::size_t number = append(std::move(holder));
    if (!node.contains("children")) node["children"] = Json::array();
    node["children"].push_back(number);
    json_["nodes"][n] = std::move(node);
    moved_weights_[n] = number;
    return number;
  }

  void add_levels_of(std::size_t n, const std::vector<std::size_t>& meshes) {
    const Json base = json_["nodes"][n];
    Json ids = Json::array(), coverage = Json::array();
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      Json node = base;
      node.erase("extras");
      node["name"] = level_name(base, level);
      node["mesh"] = meshes[level];
      ids.push_back(append(std::move(node)));
      coverage.push_back(levels_[level].screen_coverage);
      followers_[n].push_back(ids.back().get<std::size_t>());
    }
    coverage.push_back(0); // the last level is shown however small it is
    Json& node = json_["nodes"][n];
    node["extensions"][std::string(lod_extension)]["ids"] = std::move(ids);
    if (!node.contains("extras") || node["extras"].is_object())
      node["extras"]["MSFT_screencoverage"] = std::move(coverage);
  }

  // Morph weights go with the mesh to its holder, and drive the levels as well.
  void add_channels(Json& animation) {
    Json* channels = find(animation, "channels");
    if (!channels || !channels->is_array()) return;
    Json added = Json::array();
    for (Json& channel : *channels) {
      const std::optional<AnimatedNode> animated = animated_node(channel);
      if (!animated || !animated->property.starts_with("weights")) continue;
      const auto moved = moved_weights_.find(animated->node);
      const std::size_t node = moved != moved_weights_.end() ? moved->second : animated->node;
      set_animated_node(channel, node);
      const auto followers = followers_.find(node);
      if (followers == followers_.end()) continue;
      for (const std::size_t follower : followers->second) {
        Json copy = channel;
        set_animated_node(copy, follower);
        added.push_back(std::move(copy));
      }
    }
    for (Json& channel : added) channels->push_back(std::move(channel));
  }

  Json& json_;
  const LevelMeshes& meshes_;
  std::span<const NewLevel> levels_;
  NodeUse use_;
  std::map<std::size_t, std::size_t> moved_weights_;          // node -> the child that holds its mesh now
  std::map<std::size_t, std::vector<std::size_t>> followers_; // node -> its levels' nodes
};

} // namespace

void add_levels(Output& out, const Asset& asset, std::span<const NewPrimitive> full, std::span<const NewLevel> levels,
                const WritePrimitive& write) {
  if (levels.empty()) return;
  const LevelMeshes meshes = add_meshes(out, asset, full, levels, write);
  LevelNodes(out.json, meshes, levels).run();
  Json& used = out.json["extensionsUsed"];
  if (!used.is_array()) used = Json::array();
  if (std::find(used.begin(), used.end(), lod_extension) == used.end()) used.push_back(lod_extension);
}

} // namespace orbis::asset
