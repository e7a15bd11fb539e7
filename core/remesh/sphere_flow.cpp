#include "core/remesh/sphere_flow.h"

#include <Eigen/Dense>
#include <cmath>

namespace orbis::remesh {
namespace {

constexpr int steps = 64;
constexpr double width = 0.5;  // of the kernel, in radians
constexpr double ridge = 1e-7; // keeps landmarks that lie at one place from demanding two velocities
constexpr std::size_t grain = 1024;

double kernel(const Vec3d& a, const Vec3d& b) { return std::exp(-squared_norm(a - b) / (2 * width * width)); }

Vec3d tangential(const Vec3d& p, const Vec3d& v) { return v - p * dot(p, v); }

// The tangent vector at p that leads to q along the great circle, as long as the way.
Vec3d way(const Vec3d& p, const Vec3d& q) {
  const Vec3d t = tangential(p, q - p);
  const double sine = norm(t);
  return sine > 0 ? t * (std::atan2(sine, dot(p, q)) / sine) : Vec3d{};
}

// The weights of the kernels at the landmarks for a field that has the given velocities there.
std::vector<Vec3d> weights_of(const std::vector<Vec3d>& landmarks, const std::vector<Vec3d>& velocities) {
  const auto n = static_cast<Eigen::Index>(landmarks.size());
  Eigen::MatrixXd k(n, n);
  Eigen::MatrixXd v(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < n; ++j) k(i, j) = kernel(landmarks[at], landmarks[static_cast<std::size_t>(j)]);
    k(i, i) += ridge;
    v.row(i) << velocities[at].x, velocities[at].y, velocities[at].z;
  }
  const Eigen::MatrixXd w = k.ldlt().solve(v);
  std::vector<Vec3d> out;
  for (Eigen::Index i = 0; i < n; ++i) out.emplace_back(w(i, 0), w(i, 1), w(i, 2));
  return out;
}

Vec3d moved(const Vec3d& p, const std::vector<Vec3d>& landmarks, const std::vector<Vec3d>& weights) {
  Vec3d v;
  for (std::size_t i = 0; i < landmarks.size(); ++i) v += weights[i] * kernel(p, landmarks[i]);
  return normalized(p + tangential(p, v));
}

} // namespace

std::vector<Vec3d> carried(std::span<const Vec3d> points, std::span<const Vec3d> from, std::span<const Vec3d> to,
                           mesh::ThreadPool& pool) {
  std::vector<Vec3d> out(points.begin(), points.end()), landmarks(from.begin(), from.end());
  if (landmarks.empty()) return out;
  for (int step = 0; step < steps; ++step) {
    std::vector<Vec3d> velocities;
    for (std::size_t i = 0; i < landmarks.size(); ++i)
      velocities.push_back(way(landmarks[i], to[i]) * (1.0 / (steps - step)));
    const std::vector<Vec3d> weights = weights_of(landmarks, velocities);
    pool.for_blocks(out.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = moved(out[i], landmarks, weights);
    });
    const std::vector<Vec3d> before = landmarks;
    for (Vec3d& p : landmarks) p = moved(p, before, weights);
  }
  return out;
}

} // namespace orbis::remesh
