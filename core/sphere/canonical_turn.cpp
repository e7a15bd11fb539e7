#include "core/sphere/canonical_turn.h"

#include <Eigen/Dense>
#include <cmath>

#include "core/mesh/unit_positions.h"

namespace orbis::sphere {
namespace {

Eigen::Vector3d eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }

// A third of the area of its triangles for each vertex.
std::vector<double> vertex_areas(const mesh::TriangleMesh& mesh, std::span<const Vec3d> positions) {
  std::vector<double> areas(positions.size(), 0);
  for (const mesh::Triangle& t : mesh.triangles) {
    const double area = norm(cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]])) / 2;
    for (const mesh::Index v : t) areas[v] += area / 3;
  }
  return areas;
}

// sum a d s^T, with positions relative to their weighted mean.
Eigen::Matrix3d correlation(std::span<const Vec3d> positions, std::span<const double> areas,
                            std::span<const Vec3d> points) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double total = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    centroid += areas[v] * eigen(positions[v]);
    total += areas[v];
  }
  if (total > 0) centroid /= total;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    sum += areas[v] * (eigen(positions[v]) - centroid) * eigen(points[v]).transpose();
  }
  return sum;
}

} // namespace

std::vector<Vec3d> canonically_turned(const mesh::TriangleMesh& mesh, std::vector<Vec3d> points) {
  const std::vector<Vec3d> positions = mesh::unit_positions(mesh);
  const Eigen::Matrix3d m = correlation(positions, vertex_areas(mesh, positions), points);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  // The rotation is unique where s2 exceeds minus s3 (with the sign of the determinant).
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  if (!(s[1] + sign * s[2] > 1e-9 * s[0])) return points;
  const Eigen::Matrix3d r = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  for (Vec3d& p : points) {
    const Eigen::Vector3d q = (r * eigen(p)).normalized();
    p = {q.x(), q.y(), q.z()};
  }
  return points;
}

} // namespace orbis::sphere
