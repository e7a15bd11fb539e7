#include "core/steps/mirrored_tangents.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/asset/mirrored_instances.h"

namespace orbis {
namespace {

bool shows_normal_map(const asset::NewPrimitive& primitive) {
  return primitive.textures.contains(asset::TextureSlot::normal);
}

// The primitives that stand for primitive p of the asset and whose TANGENT has to go by the nodes.
std::vector<asset::NewPrimitive*> affected(const asset::Asset& asset, std::size_t p, Delivery& delivery,
                                           std::span<DetailLevel> levels) {
  std::vector<asset::NewPrimitive*> out;
  asset::NewPrimitive& full = delivery.primitives[p];
  if (shows_normal_map(full) && asset.primitives[p].find("TANGENT") == nullptr) out.push_back(&full);
  for (DetailLevel& level : levels)
    if (shows_normal_map(level.delivery.primitives[p])) out.push_back(&level.delivery.primitives[p]);
  return out;
}

} // namespace

void mirror_tangents(const asset::Asset& asset, Delivery& delivery, std::span<DetailLevel> levels, Report& report) {
  const std::vector<asset::Handedness> meshes = asset::handedness_of_meshes(asset);
  std::set<std::uint32_t> mixed;
  for (std::size_t p = 0; p < asset.primitives.size(); ++p) {
    const asset::Handedness& mesh = meshes[asset.primitives[p].mesh];
    for (asset::NewPrimitive* primitive : affected(asset, p, delivery, levels)) {
      if (mesh.mixed) mixed.insert(asset.primitives[p].mesh);
      asset::Attribute* const tangent = primitive->find("TANGENT");
      if (mesh.mirrored && mesh.straight) primitive->mirrors_tangents = true;
      if (mesh.mirrored && !mesh.straight && tangent != nullptr) asset::negate_handedness(*tangent);
    }
  }
  for (const std::uint32_t mesh : mixed)
    report.notes.push_back({"mirrored-instances",
                            "some instances of a node (EXT_mesh_gpu_instancing) mirror the mesh and others do not: its "
                            "normal map is right at those that do not, and upside down at the others",
                            "/meshes/" + std::to_string(mesh)});
}

} // namespace orbis
