#include "core/steps/mirrored_tangents.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/asset/placement.h"

namespace orbis {
namespace {

bool mirrors(const asset::Placement& placement) {
  const auto& [x, y, z] = placement.linear;
  return dot(Vec3d{x[0], x[1], x[2]}, cross(Vec3d{y[0], y[1], y[2]}, Vec3d{z[0], z[1], z[2]})) < 0;
}

bool shows_normal_map(const asset::NewPrimitive& primitive) {
  return primitive.textures.contains(asset::TextureSlot::normal);
}

void negate_w(asset::NewPrimitive& primitive) {
  asset::Attribute* const tangent = primitive.find("TANGENT");
  for (std::size_t v = 0; tangent != nullptr && v < tangent->count(); ++v) tangent->set(v, 3, -tangent->get(v, 3));
}

} // namespace

void mirror_tangents(const asset::Asset& asset, Delivery& delivery, std::span<DetailLevel> levels, Report& report) {
  const std::vector<std::vector<asset::Placement>> placements = asset::placements_of(asset);
  std::vector<bool> is_noted(placements.size());
  for (std::size_t p = 0; p < asset.primitives.size(); ++p) {
    const std::uint32_t mesh = asset.primitives[p].mesh;
    const auto mirrored = std::ranges::count_if(placements[mesh], mirrors);
    if (mirrored == 0) continue;
    const bool is_ours = shows_normal_map(delivery.primitives[p]) && asset.primitives[p].find("TANGENT") == nullptr;
    const bool in_levels = std::ranges::any_of(
        levels, [&](const DetailLevel& level) { return shows_normal_map(level.delivery.primitives[p]); });
    if (!is_ours && !in_levels) continue;
    if (mirrored < std::ssize(placements[mesh])) {
      if (!is_noted[mesh])
        report.notes.push_back({"mirrored-instances",
                                "some nodes mirror the mesh and others do not: its normal map is right at those that "
                                "do not, and upside down at the others",
                                "/meshes/" + std::to_string(mesh)});
      is_noted[mesh] = true;
      continue;
    }
    if (is_ours) negate_w(delivery.primitives[p]);
    for (DetailLevel& level : levels)
      if (shows_normal_map(level.delivery.primitives[p])) negate_w(level.delivery.primitives[p]);
  }
}

} // namespace orbis
