// Sander, Snyder, Gortler, Hoppe: Texture mapping progressive meshes (2001) for the L2 stretch; Smith and Schaefer:
// Bijective parameterization with free boundaries (2015) for the symmetric Dirichlet energy.
#include "core/sphere/distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/sphere/sphere_math.h"

namespace orbis::sphere {
namespace {

struct Stretch {
  double area;  // of the surface triangle
  double image; // of its chordal image
  double trace; // s1^2 + s2^2
};

double doubled_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return norm(cross(b - a, c - a)); }

// s1^2 + s2^2 = trace of the first fundamental form of the inverse = sum of cot(angle) * (opposite image edge)^2 over
// twice the area (Pinkall and Polthier 1993), and s1 s2 = ratio of the areas.
Stretch stretch_of(const std::array<Vec3d, 3>& p, const std::array<Vec3d, 3>& q) {
  const double twice = doubled_area(p[0], p[1], p[2]);
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum += dot(p[i] - p[k], p[j] - p[k]) * squared_norm(q[i] - q[j]);
  }
  return {twice / 2, doubled_area(q[0], q[1], q[2]) / 2, sum / (twice * twice)};
}

// Lower than 1e-7 of its longest edge; also true of a triangle without area.
bool is_needle(const std::array<Vec3d, 3>& p, double area) {
  const double longest = std::max({squared_norm(p[1] - p[0]), squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2])});
  return !(2 * area > 1e-7 * longest);
}

double percentile(std::vector<std::pair<double, double>>& value_and_weight, double fraction) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double total = 0, below = 0;
  for (const auto& [value, weight] : value_and_weight) total += weight;
  for (const auto& [value, weight] : value_and_weight) {
    below += weight;
    if (below >= fraction * total) return value;
  }
  return 1;
}

// The measures of one triangle after scaling the map by `scale` in length.
struct Measures {
  double qc, log_area, dirichlet, stretch;
};

Measures measures_of(const Stretch& s, double scale) {
  const double trace = s.trace * scale * scale;                      // s1^2 + s2^2
  const double product = s.image / s.area * scale * scale;           // s1 s2
  const double root = std::sqrt(std::max(0.0, trace + 2 * product)); // s1 + s2
  const double difference = std::sqrt(std::max(0.0, trace - 2 * product));
  const double inverse = trace / (product * product); // 1/s1^2 + 1/s2^2
  // s1 / s2 = s1^2 / (s1 s2), which does not cancel.
  const double larger = (root + difference) / 2;
  return {larger * larger / product, std::log(product), (trace + inverse) / 4, inverse / 2};
}

} // namespace

Distortion measure_distortion(const mesh::TriangleMesh& mesh, std::span<const Vec3f> points) {
  Distortion out;
  std::vector<Stretch> stretches;
  stretches.reserve(mesh.triangles.size());
  // Coordinates up to 3e38 are squared twice below: bring them to about 1 first.
  double extent = 0;
  for (const Vec3f& p : mesh.positions) {
    extent = std::max({extent, std::abs(double{p.x}), std::abs(double{p.y}), std::abs(double{p.z})});
  }
  const double unit = extent > 0 ? 1 / extent : 1;
  double surface = 0, image = 0;
  out.smallest_area = 4 * std::numbers::pi;
  for (const mesh::Triangle& t : mesh.triangles) {
    std::array<Vec3d, 3> p, q;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = Vec3d(mesh.positions[t[k]]) * unit;
      q[k] = Vec3d(points[t[k]]);
    }
    out.smallest_area = std::min(out.smallest_area, solid_angle(q[0], q[1], q[2]));
    const Stretch s = stretch_of(p, q);
    if (is_needle(p, s.area) || !(s.image > 0)) {
      ++out.needles;
      continue;
    }
    image += s.image;
    surface += s.area;
    stretches.push_back(s);
  }
  if (stretches.empty()) return out;

  const double scale = std::sqrt(surface / image);
  std::vector<std::pair<double, double>> qc;
  qc.reserve(stretches.size());
  double weight = 0, qc_sum = 0, log_sum = 0, log_squares = 0, dirichlet = 0, stretch = 0;
  for (const Stretch& s : stretches) {
    const Measures m = measures_of(s, scale);
    weight += s.area;
    qc_sum += s.area * m.qc;
    log_sum += s.area * m.log_area;
    log_squares += s.area * m.log_area * m.log_area;
    dirichlet += s.area * m.dirichlet;
    stretch += s.area * m.stretch;
    qc.emplace_back(m.qc, s.area);
  }
  out.quasi_conformal_mean = qc_sum / weight;
  out.quasi_conformal_p99 = percentile(qc, 0.99);
  const double mean_log = log_sum / weight;
  out.log_area_deviation = std::sqrt(std::max(0.0, log_squares / weight - mean_log * mean_log));
  out.symmetric_dirichlet = dirichlet / weight;
  out.l2_stretch = std::sqrt(stretch / weight);
  return out;
}

} // namespace orbis::sphere
