#include "core/sphere/reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 4096;
constexpr double smallest_area = 1e-6; // in units of the mean area

// With d added to the squared lengths l0, l1, l2 of a triangle of area A, Heron's formula gives
// 16 A'^2 = 16 A^2 + 2 d (l0 + l1 + l2) + 3 d^2, free of cancellation.
Reference reference_of(const Vec3d& p0, const Vec3d& p1, const Vec3d& p2, double regularisation) {
  const double l0 = squared_norm(p2 - p1), l1 = squared_norm(p0 - p2), l2 = squared_norm(p1 - p0);
  const double sum = l0 + l1 + l2, d = regularisation * sum / 3;
  const double four_areas = std::sqrt(4 * squared_norm(cross(p1 - p0, p2 - p0)) + 2 * d * sum + 3 * d * d);
  if (!(four_areas > 0)) {
    constexpr auto equilateral = static_cast<float>(std::numbers::inv_sqrt3);
    return {{equilateral, equilateral, equilateral}, 0};
  }
  const auto cot = [&](double opposite) { return static_cast<float>((sum + d - 2 * opposite) / four_areas); };
  return {{cot(l0), cot(l1), cot(l2)}, static_cast<float>(four_areas / 4)};
}

} // namespace

void compute_references(std::span<const Vec3d> positions, std::span<const mesh::Triangle> triangles,
                        double regularisation, mesh::ThreadPool& pool, std::vector<Reference>& out) {
  out.resize(triangles.size());
  const double total = pool.sum_blocks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const mesh::Triangle& t = triangles[i];
      out[i] = reference_of(positions[t[0]], positions[t[1]], positions[t[2]], regularisation);
      sum += double{out[i].area};
    }
    return sum;
  });
  const double mean = 4 * std::numbers::pi / static_cast<double>(triangles.size());
  const double scale = total > 0 ? 4 * std::numbers::pi / total : 0;
  const double floor = total > 0 ? mean * smallest_area : mean;
  pool.for_blocks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float& area = out[i].area;
      area = static_cast<float>(std::max(floor, double{area} * scale));
    }
  });
}

} // namespace orbis::sphere
