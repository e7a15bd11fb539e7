// Surfaces that hide the sky, but for their backs and what masks leave out of them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/texture/raster.h"
#include "core/texture/ray_tree.h"
#include "core/texture/sampler.h"
#include "core/vec3.h"

namespace orbis::texture {

// The alpha of a triangle whose material is a mask.
struct AlphaMask {
  const Sampler* texture = nullptr;    // null: the corners alone
  std::array<RasterPoint, 3> texels;   // its corners in the texture
  std::array<float, 3> alpha{1, 1, 1}; // at its corners: what the texture is multiplied by
  float cutoff = 0.5F;

  // u, v: weights of the second and third corner.
  [[nodiscard]] bool leaves_out(float u, float v) const;
};

// What a triangle hides.
struct Occluder {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t component = 0;      // of the surface
  bool hides_what_is_behind = true; // from rays that come from behind it, too; else only its own component does
  std::uint32_t mask = none;
};

class OccluderTree {
public:
  // occluders: one per triangle; masks: what they count in. Without them all triangles hide all.
  OccluderTree(std::span<const Vec3f> positions, std::span<const mesh::Triangle> triangles,
               std::vector<Occluder> occluders = {}, std::vector<AlphaMask> masks = {});

  // Whether something hides the sky in this direction from a point of a component.
  [[nodiscard]] bool hides(const Vec3f& origin, const Vec3f& direction, std::uint32_t component) const;

private:
  RayTree tree_;
  std::vector<Occluder> occluders_; // empty: plain ones
  std::vector<AlphaMask> masks_;
};

} // namespace orbis::texture
