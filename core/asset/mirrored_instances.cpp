#include "core/asset/mirrored_instances.h"

#include <algorithm>
#include <optional>
#include <string>

#include "core/asset/extensions.h"
#include "core/asset/instances.h"
#include "core/asset/nodes.h"

namespace orbis::asset {
namespace {

// Which nodes mirror what they show, as they stand at rest.
class NodeSides {
public:
  explicit NodeSides(const Json& document)
      : document_(document), mirrored_(array_size(document, "nodes")), is_seen_(mirrored_.size()),
        has_parent_(mirrored_.size()) {
    std::vector<bool> is_level(mirrored_.size());
    for (std::size_t n = 0; n < mirrored_.size(); ++n) {
      for (const std::size_t child : children(n)) has_parent_[child] = true;
      for (const std::size_t level : levels(n)) is_level[level] = true;
    }
    for (std::size_t n = 0; n < mirrored_.size(); ++n)
      if (!has_parent_[n] && !is_level[n]) walk(n);
    for (std::size_t n = 0; n < mirrored_.size(); ++n) walk(n); // levels of each other alone
  }

  [[nodiscard]] bool operator[](std::size_t n) const { return mirrored_[n]; }

private:
  struct Step {
    std::size_t node;
    bool parent_mirrors;
  };

  [[nodiscard]] const Json& node(std::size_t n) const { return document_["nodes"][n]; }
  static std::vector<std::size_t> numbers(const Json* list) {
    return list && list->is_array() ? list->get<std::vector<std::size_t>>() : std::vector<std::size_t>{};
  }
  [[nodiscard]] std::vector<std::size_t> children(std::size_t n) const { return numbers(find(node(n), "children")); }
  [[nodiscard]] std::vector<std::size_t> levels(std::size_t n) const {
    return numbers(find_path(node(n), "extensions", lod_extension, "ids"));
  }

  void walk(std::size_t root) {
    std::vector<Step> waiting{{root, false}};
    while (!waiting.empty()) {
      const auto [n, parent_mirrors] = waiting.back();
      waiting.pop_back();
      if (is_seen_[n]) continue;
      is_seen_[n] = true;
      const bool here = mirrors(local_placement(JsonReader(document_), node(n)).linear) != parent_mirrors;
      mirrored_[n] = here;
      for (const std::size_t child : children(n)) waiting.push_back({child, here});
      // A level stands where the node itself does, with a transform of its own.
      for (const std::size_t level : levels(n))
        if (!has_parent_[level]) waiting.push_back({level, parent_mirrors});
    }
  }

  const Json& document_;
  std::vector<bool> mirrored_, is_seen_, has_parent_;
};

// What EXT_mesh_gpu_instancing makes of left and right.
enum class Instances { straight, mirrored, mixed };

Instances sides_of(const std::optional<Attribute>& scales) {
  if (!scales) return Instances::straight;
  std::size_t mirrored = 0;
  for (std::size_t i = 0; i < scales->count(); ++i) {
    const Vec3d s = vector_at(*scales, i);
    if (s.x * s.y * s.z < 0) ++mirrored;
  }
  return mirrored == 0 ? Instances::straight : mirrored == scales->count() ? Instances::mirrored : Instances::mixed;
}

// Calls visit(node, mesh, whether it is mirrored, whether its instances are mixed) for every node that shows a mesh.
// json: the asset's document, or what became of it.
template <class Visit> void for_meshes(const Json& json, const Asset& asset, Visit visit) {
  const NodeSides sides(json);
  InstanceReader instances_of_nodes(*asset.document);
  for (std::size_t n = 0; n < array_size(json, "nodes"); ++n) {
    const Json& node = json["nodes"][n];
    const Json* mesh = find(node, "mesh");
    if (!mesh) continue;
    const Instances instances = sides_of(instances_of_nodes.attribute(node, "SCALE"));
    const bool is_mixed = instances == Instances::mixed;
    const bool is_mirrored = !is_mixed && !find(node, "skin") && sides[n] != (instances == Instances::mirrored);
    visit(n, mesh->get<std::size_t>(), is_mirrored, is_mixed);
  }
}

} // namespace

std::vector<Handedness> handedness_of_meshes(const Asset& asset) {
  std::vector<Handedness> out(array_size(asset.document->json, "meshes"));
  for_meshes(asset.document->json, asset, [&](std::size_t, std::size_t mesh, bool is_mirrored, bool is_mixed) {
    (is_mirrored ? out[mesh].mirrored : out[mesh].straight) = true;
    if (is_mixed) out[mesh].mixed = true;
  });
  for (Handedness& mesh : out)
    if (!mesh.mirrored) mesh.straight = true;
  return out;
}

void MirroredInstances::add(const Json& primitive, const NewPrimitive& geometry) {
  const Json* tangent = find_path(primitive, "attributes", "TANGENT");
  if (geometry.mirrors_tangents && tangent) by_tangent_[tangent->get<std::size_t>()] = &geometry;
}

void MirroredInstances::split() {
  if (by_tangent_.empty()) return;
  std::vector<std::size_t> nodes;
  for_meshes(out_.json, asset_, [&](std::size_t n, std::size_t mesh, bool is_mirrored, bool) {
    if (is_mirrored && is_affected(out_.json["meshes"][mesh])) nodes.push_back(n);
  });
  for (const std::size_t n : nodes) {
    const std::size_t copy = copy_of(out_.json["nodes"][n]["mesh"].get<std::size_t>());
    out_.json["nodes"][n]["mesh"] = copy;
  }
  animate_copies(out_.json, "meshes", copies_);
}

bool MirroredInstances::is_affected(const Json& mesh) const {
  const Json& primitives = mesh["primitives"];
  return std::any_of(primitives.begin(), primitives.end(), [&](const Json& primitive) {
    const Json* tangent = find_path(primitive, "attributes", "TANGENT");
    return tangent && by_tangent_.contains(tangent->get<std::size_t>());
  });
}

Json MirroredInstances::mirrored(Json primitive) {
  const Json* number = find_path(primitive, "attributes", "TANGENT");
  const auto found = number ? by_tangent_.find(number->get<std::size_t>()) : by_tangent_.end();
  if (found == by_tangent_.end()) return primitive;
  Attribute tangent = *found->second->find("TANGENT");
  negate_handedness(tangent);
  primitive["attributes"]["TANGENT"] = out_.add_attribute(tangent);
  // What is compressed with the rest is the other one.
  if (Json* compressed = find_path(primitive, "extensions", draco_extension, "attributes"))
    compressed->erase("TANGENT");
  return primitive;
}

std::size_t MirroredInstances::copy_of(std::size_t mesh) {
  if (const auto known = number_of_copy_.find(mesh); known != number_of_copy_.end()) return known->second;
  Json copy = out_.json["meshes"][mesh];
  for (Json& primitive : copy["primitives"]) primitive = mirrored(primitive);
  const std::size_t number = out_.json["meshes"].size();
  out_.json["meshes"].push_back(std::move(copy));
  copies_.push_back({mesh, number});
  number_of_copy_[mesh] = number;
  return number;
}

} // namespace orbis::asset
