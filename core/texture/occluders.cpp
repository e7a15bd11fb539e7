#include "core/texture/occluders.h"

#include <algorithm>
#include <utility>

namespace orbis::texture {

bool AlphaMask::leaves_out(float u, float v) const {
  const std::array<float, 3> weights{1 - u - v, u, v};
  float value = 0;
  RasterPoint place;
  for (std::size_t k = 0; k < 3; ++k) {
    value += weights[k] * alpha[k];
    place.x += double{weights[k]} * texels[k].x;
    place.y += double{weights[k]} * texels[k].y;
  }
  if (texture != nullptr) value *= texture->nearest(place.x, place.y)[3];
  return value < cutoff;
}

OccluderTree::OccluderTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles,
                           std::vector<Occluder> occluders, std::vector<AlphaMask> masks)
    : tree_(positions, triangles), occluders_(std::move(occluders)), masks_(std::move(masks)) {
  const bool all_plain = std::ranges::all_of(
      occluders_, [](const Occluder& o) { return o.hides_what_is_behind && o.mask == Occluder::none; });
  if (all_plain) occluders_.clear();
}

bool OccluderTree::hides(const Vec3f& origin, const Vec3f& direction, std::uint32_t component) const {
  if (occluders_.empty()) return tree_.meets(origin, direction);
  // Two words, which std::function holds without an allocation.
  return tree_.meets(origin, direction, [this, component](const RayHit& hit) {
    const Occluder& o = occluders_[hit.triangle];
    if (hit.from_behind && !o.hides_what_is_behind && o.component != component) return false;
    return o.mask == Occluder::none || !masks_[o.mask].leaves_out(hit.u, hit.v);
  });
}

} // namespace orbis::texture
