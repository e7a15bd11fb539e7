#include "core/mesh/orient.h"

#include <utility>

namespace orbis::mesh {
namespace {

// Turns triangle t, with what is glued to its half-edges: 0 and 2 change places.
void turn(Gluing& gluing, std::uint32_t t) {
  std::swap(gluing.triangles[t][1], gluing.triangles[t][2]);
  const std::uint32_t a = 3 * t, c = 3 * t + 2;
  const std::uint32_t to_a = gluing.twin[a], to_c = gluing.twin[c];
  // An edge may be glued to another edge of the same triangle.
  gluing.twin[a] = to_c == a ? c : to_c;
  gluing.twin[c] = to_a == c ? a : to_a;
  if (gluing.twin[a] != open_edge) gluing.twin[gluing.twin[a]] = a;
  if (gluing.twin[c] != open_edge) gluing.twin[gluing.twin[c]] = c;
}

class Walk {
public:
  Walk(std::span<const Vec3f> positions, Gluing& gluing)
      : positions_(positions), gluing_(gluing), seen_(gluing.triangles.size(), false) {
    out_.turned.assign(gluing.triangles.size(), false);
  }

  Orientation run() {
    for (std::uint32_t t = 0; t < seen_.size(); ++t) {
      if (!seen_[t]) piece_from(t);
    }
    for (std::uint32_t t = 0; t < seen_.size(); ++t) {
      if (out_.turned[t]) turn(gluing_, t);
    }
    return std::move(out_);
  }

private:
  // Breadth first, so that what must be cut is where two fronts meet: a short way across the strip.
  void piece_from(std::uint32_t first) {
    queue_.assign(1, first);
    seen_[first] = true;
    bool closed = true;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t t = queue_[i];
      turned += out_.turned[t] ? 1 : 0;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (!gluing_.is_open(h)) meet(h);
        closed = closed && !gluing_.is_open(h);
      }
    }
    if (turned == 0) return;
    if (closed ? volume() < 0 : 2 * turned > queue_.size()) {
      for (const std::uint32_t t : queue_) out_.turned[t] = !out_.turned[t];
    }
  }

  void meet(std::uint32_t h) {
    const std::uint32_t g = gluing_.twin[h], s = g / 3;
    const bool opposite = gluing_.from(h) == gluing_.to(g) && gluing_.to(h) == gluing_.from(g);
    const bool wanted = opposite ? out_.turned[h / 3] : !out_.turned[h / 3];
    if (!seen_[s]) {
      seen_[s] = true;
      out_.turned[s] = wanted;
      queue_.push_back(s);
    } else if (out_.turned[s] != wanted) {
      gluing_.unglue(h);
      ++out_.cut_edges;
    }
  }

  // Six times the volume of the piece, its triangles turned as they are to be.
  [[nodiscard]] double volume() const {
    const Vec3d origin(positions_[gluing_.triangles[queue_.front()][0]]);
    double sum = 0;
    for (const std::uint32_t t : queue_) {
      const auto& [i, j, k] = gluing_.triangles[t];
      const Vec3d a = Vec3d(positions_[i]) - origin, b = Vec3d(positions_[j]) - origin,
                  c = Vec3d(positions_[k]) - origin;
      sum += (out_.turned[t] ? -1 : 1) * dot(a, cross(b, c));
    }
    return sum;
  }

  std::span<const Vec3f> positions_;
  Gluing& gluing_;
  std::vector<bool> seen_;
  std::vector<std::uint32_t> queue_;
  Orientation out_;
};

} // namespace

Orientation orient(std::span<const Vec3f> positions, Gluing& gluing) { return Walk(positions, gluing).run(); }

} // namespace orbis::mesh
