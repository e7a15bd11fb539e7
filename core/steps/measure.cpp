#include "core/steps/measure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orbis {
namespace {

// The means of measures that are means themselves, weighted by area; the 99th percentile becomes the worst of them.
class Mean {
public:
  void add(const sphere::Distortion& d, double area) {
    weight_ += area;
    out_.quasi_conformal_mean += area * d.quasi_conformal_mean;
    out_.quasi_conformal_p99 = std::max(out_.quasi_conformal_p99, d.quasi_conformal_p99);
    out_.log_area_deviation += area * d.log_area_deviation * d.log_area_deviation;
    out_.symmetric_dirichlet += area * d.symmetric_dirichlet;
    out_.l2_stretch += area * d.l2_stretch * d.l2_stretch;
    out_.smallest_area = count_ == 0 ? d.smallest_area : std::min(out_.smallest_area, d.smallest_area);
    out_.needles += d.needles;
    ++count_;
  }
  [[nodiscard]] sphere::Distortion get() const {
    sphere::Distortion out = out_;
    out.quasi_conformal_mean /= weight_;
    out.log_area_deviation = std::sqrt(out.log_area_deviation / weight_);
    out.symmetric_dirichlet /= weight_;
    out.l2_stretch = std::sqrt(out.l2_stretch / weight_);
    return out;
  }
  [[nodiscard]] bool is_empty() const { return !(weight_ > 0); }

private:
  sphere::Distortion out_{0, 1, 0, 0, 0, 0, 0};
  double weight_ = 0;
  std::size_t count_ = 0;
};

} // namespace

double area_of(const mesh::TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a(mesh.positions[i]), b(mesh.positions[j]), c(mesh.positions[k]);
    sum += norm(cross(b - a, c - a)) / 2;
  }
  return sum;
}

sphere::Distortion measure(const Surface& surface, std::span<const Vec3f> points, Report& report) {
  if (surface.components.size() == 1 && !surface.components[0].has_caps()) {
    return report.components[surface.components[0].number].distortion =
               sphere::measure_distortion(surface.mesh, points);
  }
  Mean mean;
  for (const Component& c : surface.components) {
    const mesh::TriangleMesh piece = input_mesh_of(surface, c);
    sphere::Distortion& one = report.components[c.number].distortion;
    one = sphere::measure_distortion(piece, points.subspan(c.first_vertex, c.input_vertices));
    mean.add(one, area_of(piece));
  }
  return mean.is_empty() ? sphere::Distortion{} : mean.get();
}

} // namespace orbis
