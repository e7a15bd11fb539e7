#include "core/texture/projection.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace orbis::texture {
namespace {

constexpr double margin = 0.07;      // of the viewport's smaller side
constexpr double eye_distance = 4.2; // radii of the bounding sphere

// On the image plane, with its outline.
struct Projection {
  std::vector<Projected> points;
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  double x_low = infinity, x_high = -infinity, y_low = infinity, y_high = -infinity;

  // Never 0, so that what is seen edge-on can be scaled too.
  [[nodiscard]] double width() const { return std::max(x_high - x_low, 1e-6); }
  [[nodiscard]] double height() const { return std::max(y_high - y_low, 1e-6); }

  void add(const Projected& p) {
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
    points.push_back(p);
  }
};

Projection on_image_plane(std::span<const Vec3d> positions) {
  Vec3d low = positions[0], high = positions[0];
  for (const Vec3d& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3d centre = (low + high) * 0.5;
  double radius = 0;
  for (const Vec3d& p : positions) radius = std::max(radius, norm(p - centre));
  Projection projection;
  projection.points.reserve(positions.size());
  for (const Vec3d& p : positions) {
    const Vec3d d = (p - centre) * (1 / radius);
    const double inverse_depth = 1 / (eye_distance - dot(d, view_z));
    projection.add({dot(d, view_x) * inverse_depth, -dot(d, view_y) * inverse_depth, inverse_depth});
  }
  return projection;
}

} // namespace

std::vector<Projected> projected(std::span<const Vec3d> positions, const Viewport& view) {
  Projection projection = on_image_plane(positions);
  const double border = margin * std::min(view.width, view.height);
  const double scale =
      std::min((view.width - 2 * border) / projection.width(), (view.height - 2 * border) / projection.height());
  for (Projected& p : projection.points) {
    p.x = subpixels * (0.5 * view.width + scale * (p.x - 0.5 * (projection.x_low + projection.x_high)));
    p.y = subpixels * (0.5 * view.height + scale * (p.y - 0.5 * (projection.y_low + projection.y_high)));
  }
  return std::move(projection.points);
}

double aspect_of(std::span<const Vec3d> positions) {
  const Projection projection = on_image_plane(positions);
  return projection.width() / projection.height();
}

} // namespace orbis::texture
