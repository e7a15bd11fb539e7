#include "core/asset/instances.h"

#include <algorithm>
#include <array>

#include "core/asset/nodes.h"

namespace orbis::asset {

std::optional<Attribute> InstanceReader::attribute(const Json& node, const std::string& name) {
  const Json* number = find_path(node, "extensions", "EXT_mesh_gpu_instancing", "attributes", name);
  if (!number) return std::nullopt;
  if (!model_) model_.emplace(typed_model(document_.json));
  Attribute out = AccessorReader(document_, *model_).attribute(number->get<std::size_t>(), name);
  if (out.components != (name == "ROTATION" ? 4U : 3U)) return std::nullopt;
  return out;
}

std::vector<Placement> InstanceReader::placements(const Json& node, std::size_t most) {
  const std::optional<Attribute> t = attribute(node, "TRANSLATION"), r = attribute(node, "ROTATION"),
                                 s = attribute(node, "SCALE");
  std::size_t count = 0;
  for (const auto* a : {&t, &r, &s})
    if (*a) count = count == 0 ? (*a)->count() : std::min(count, (*a)->count());
  if (count == 0) return {Placement{}};
  std::vector<Placement> out;
  for (std::size_t i = 0; i < std::min(count, most); ++i) {
    const Vec3d scale = s ? vector_at(*s, i) : Vec3d{1, 1, 1}, offset = t ? vector_at(*t, i) : Vec3d{};
    const Vec3d q = r ? vector_at(*r, i) : Vec3d{};
    out.push_back(placed(offset, {q.x, q.y, q.z, r ? r->get(i, 3) : 1}, scale));
  }
  return out;
}

} // namespace orbis::asset
