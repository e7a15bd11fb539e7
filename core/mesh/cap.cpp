#include "core/mesh/cap.h"

#include <algorithm>
#include <numbers>

namespace orbis::mesh {
namespace {

constexpr std::size_t longest_fan = 8;

// The centroid of the loop as a wire, so that a stretch of many short edges does not pull it over.
Vec3d centroid(std::span<const Vec3d> ring) {
  Vec3d sum, plain;
  double length = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const double l = norm(b - a);
    sum += (a + b) * (l / 2);
    length += l;
    plain += a * (1 / static_cast<double>(ring.size()));
  }
  return length > 0 ? sum * (1 / length) : plain;
}

class Builder {
public:
  explicit Builder(std::span<const Vec3f> loop) : next_(static_cast<Index>(loop.size())) {
    for (Index i = 0; i < loop.size(); ++i) {
      ring_.emplace_back(loop[i]);
      index_.push_back(i);
    }
    centre_ = centroid(ring_);
  }

  Cap run() {
    while (ring_.size() > longest_fan) add_ring();
    const Index apex = add(centre_);
    for (std::size_t i = 0; i < ring_.size(); ++i) out_.triangles.push_back({index_at(i + 1), index_[i], apex});
    return std::move(out_);
  }

private:
  Index add(const Vec3d& p) {
    out_.positions.emplace_back(p);
    return next_++;
  }
  [[nodiscard]] Index index_at(std::size_t i) const { return index_[i % index_.size()]; }

  // Every second vertex goes inward, by about the length of an edge between the two rings where the loop is round.
  void add_ring() {
    const std::size_t n = ring_.size();
    const double step = 2 * std::numbers::pi / static_cast<double>(n);
    const double towards_centre = std::min(1.2 * step, 0.6);
    std::vector<Vec3d> inner;
    std::vector<Index> inner_index;
    for (std::size_t i = 0; i < n; i += 2) {
      const Vec3d smooth = (ring_[(i + n - 1) % n] + ring_[i] * 2.0 + ring_[(i + 1) % n]) * 0.25;
      inner.push_back(smooth + (centre_ - smooth) * towards_centre);
      inner_index.push_back(add(inner.back()));
    }
    for (std::size_t j = 0; j < inner.size(); ++j) {
      const Index b = inner_index[j], c = inner_index[(j + 1) % inner.size()];
      const std::size_t i = 2 * j;
      out_.triangles.push_back({index_at(i + 1), index_[i], b});
      out_.triangles.push_back({index_at(i + 1), b, c});
      // With an odd number of vertices the last step is half as wide.
      if (i + 1 < n) out_.triangles.push_back({index_at(i + 2), index_at(i + 1), c});
    }
    ring_ = std::move(inner);
    index_ = std::move(inner_index);
  }

  std::vector<Vec3d> ring_;
  std::vector<Index> index_;
  Vec3d centre_;
  Index next_;
  Cap out_;
};

} // namespace

Cap make_cap(std::span<const Vec3f> loop) { return Builder(loop).run(); }

} // namespace orbis::mesh
