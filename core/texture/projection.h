// The camera of the pictures: where on the screen points are seen.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/texture/raster.h"
#include "core/vec3.h"

namespace orbis::texture {

inline constexpr std::uint32_t subpixels = 2; // in each direction

// Part of a picture, in pixels.
struct Viewport {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

// The camera's axes: x to the right, y up, z towards the viewer, who stands in front (+Z), 30 degrees to the right and
// 20 degrees up.
inline const Vec3d view_z = normalized(Vec3d{0.50, 0.42, 0.87});
inline const Vec3d view_x = normalized(cross(Vec3d{0, 1, 0}, view_z));
inline const Vec3d view_y = cross(view_z, view_x);

struct Projected {
  double x = 0, y = 0;      // sub-pixels from the viewport's corner, y down
  double inverse_depth = 0; // 1 / distance from the eye along the view
};

// In perspective, with the eye at a few radii; the outline fills the viewport but for a margin. At least one position.
[[nodiscard]] std::vector<Projected> projected(std::span<const Vec3d> positions, const Viewport& viewport);

// Width / height of the outline.
[[nodiscard]] double aspect_of(std::span<const Vec3d> positions);

[[nodiscard]] inline std::array<RasterPoint, 3> corners_of(const mesh::Triangle& triangle,
                                                           std::span<const Projected> points) {
  std::array<RasterPoint, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = {points[triangle[k]].x, points[triangle[k]].y};
  return corners;
}

// Whether the corners go clockwise as they are seen: the triangle shows its back. y goes down.
[[nodiscard]] inline bool is_seen_from_behind(const std::array<RasterPoint, 3>& p) {
  return (p[1].x - p[0].x) * (p[2].y - p[0].y) > (p[2].x - p[0].x) * (p[1].y - p[0].y);
}

} // namespace orbis::texture
