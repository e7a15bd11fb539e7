#include "core/asset/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace orbis::asset {
namespace {

struct Point {
  double x = 0, y = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

// Twice the signed area of a triangle.
double area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon seen along the axis that its vector area (Newell) is closest to, turned so that it runs
// counter-clockwise.
std::vector<Point> flattened(std::span<const Vec3f> corners) {
  Vec3d normal;
  const Vec3d origin(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += cross(Vec3d(corners[i]) - origin, Vec3d(corners[(i + 1) % corners.size()]) - origin);
  }
  const double nx = std::abs(normal.x), ny = std::abs(normal.y), nz = std::abs(normal.z);
  std::vector<Point> points;
  for (const Vec3f& corner : corners) {
    const Vec3d p(corner);
    if (nx >= ny && nx >= nz) {
      points.push_back(normal.x < 0 ? Point{p.z, p.y} : Point{p.y, p.z});
    } else if (ny >= nz) {
      points.push_back(normal.y < 0 ? Point{p.x, p.z} : Point{p.z, p.x});
    } else {
      points.push_back(normal.z < 0 ? Point{p.y, p.x} : Point{p.x, p.y});
    }
  }
  return points;
}

class EarClipper {
public:
  explicit EarClipper(std::span<const Vec3f> corners) : points_(flattened(corners)), left_(corners.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> triangles;
    std::size_t from = 0;
    while (left_.size() > 3) {
      const std::size_t ear = find_ear(from);
      triangles.insert(triangles.end(), {at(ear + left_.size() - 1), at(ear), at(ear + 1)});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      from = ear; // the next corner, so that the ears do not all meet in one
    }
    triangles.insert(triangles.end(), left_.begin(), left_.end());
    return triangles;
  }

private:
  [[nodiscard]] std::uint32_t at(std::size_t i) const { return left_[i % left_.size()]; }

  // The first ear from a place on. A polygon that crosses itself may have none: then the place itself.
  [[nodiscard]] std::size_t find_ear(std::size_t from) const {
    for (std::size_t k = 0; k < left_.size(); ++k) {
      if (is_ear((from + k) % left_.size())) return (from + k) % left_.size();
    }
    return from % left_.size();
  }

  [[nodiscard]] bool is_ear(std::size_t i) const {
    const std::uint32_t before = at(i + left_.size() - 1), tip = at(i), after = at(i + 1);
    const Point &a = points_[before], &b = points_[tip], &c = points_[after];
    if (area(a, b, c) <= 0) return false;
    const auto contains = [&](std::uint32_t other) {
      if (other == before || other == tip || other == after) return false;
      const Point& p = points_[other];
      if (p == a || p == b || p == c) return false; // where a cut leads to a hole and back
      return area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
    };
    return std::ranges::none_of(left_, contains);
  }

  std::vector<Point> points_;
  std::vector<std::uint32_t> left_;
};

// Which diagonals of a quadrilateral lie inside it; where both do, the shorter one.
std::vector<std::uint32_t> split_quadrilateral(std::span<const Vec3f> corners) {
  const std::vector<Point> p = flattened(corners);
  const bool first = area(p[0], p[1], p[2]) > 0 && area(p[0], p[2], p[3]) > 0;
  const bool second = area(p[1], p[2], p[3]) > 0 && area(p[1], p[3], p[0]) > 0;
  const float length_first = squared_norm(corners[2] - corners[0]),
              length_second = squared_norm(corners[3] - corners[1]);
  if (second && (!first || length_second < length_first)) return {0, 1, 3, 1, 2, 3};
  return {0, 1, 2, 0, 2, 3};
}

} // namespace

std::vector<std::uint32_t> triangulate_polygon(std::span<const Vec3f> corners) {
  if (corners.size() == 3) return {0, 1, 2};
  if (corners.size() == 4) return split_quadrilateral(corners);
  return EarClipper(corners).run();
}

} // namespace orbis::asset
