#include "core/asset/mend_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace orbis::asset {
namespace {

// How far float unit vectors and sums of weights are off for their rounding alone, generously.
constexpr double unit_tolerance = 0.005, sum_tolerance = 1e-6;

void set_vector(Attribute& a, std::size_t v, const Vec3d& value) {
  a.set(v, 0, value.x);
  a.set(v, 1, value.y);
  a.set(v, 2, value.z);
}

bool is_unit(const Vec3d& n) { return std::abs(norm(n) - 1) <= unit_tolerance; }

// Some unit vector across n.
Vec3d across(const Vec3d& n) {
  const Vec3d axis = std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d t = cross(n, axis);
  return norm(t) > 0 ? normalized(t) : Vec3d{1, 0, 0};
}

// Area-weighted normals of the triangles around each vertex, not scaled. Positions are taken relative to the largest
// coordinate, so that no product overflows.
std::vector<Vec3d> surface_normals(const Primitive& primitive) {
  const std::vector<Vec3f> positions = primitive.positions();
  double largest = 0;
  for (const Vec3f& p : positions)
    largest = std::max({largest, std::abs(double{p.x}), std::abs(double{p.y}), std::abs(double{p.z})});
  std::vector<Vec3d> out(positions.size());
  if (!(largest > 0)) return out;
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    std::array<Vec3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = Vec3d(positions[primitive.indices[i + k]]) * (1 / largest);
    const Vec3d area = cross(p[1] - p[0], p[2] - p[0]);
    for (std::size_t k = 0; k < 3; ++k) out[primitive.indices[i + k]] += area;
  }
  return out;
}

bool is_of(const Attribute& a, std::string_view family) {
  return a.name.starts_with(family) && a.name.size() > family.size() && a.name[family.size()] == '_';
}

class Mender {
public:
  Mender(Primitive& primitive, std::vector<Asset::Note>& notes)
      : primitive_(primitive), notes_(notes),
        where_("/meshes/" + std::to_string(primitive.mesh) + "/primitives/" + std::to_string(primitive.primitive)) {}

  void run() {
    for (Attribute& a : primitive_.attributes) {
      if (a.type != ComponentType::f32 || a.name == "POSITION") continue;
      tell(make_finite(a), a, "were infinite or no numbers, and are 0 now", "/attributes/");
      if (a.name == "NORMAL") tell(mend_normals(a), a, "were no unit vectors, and are now", "/attributes/");
      if (is_of(a, "COLOR")) tell(clamp(a), a, "were outside of 0 to 1, and are clamped", "/attributes/");
    }
    // Across the normals, when those are right.
    for (Attribute& a : primitive_.attributes) {
      if (a.type != ComponentType::f32 || a.name != "TANGENT") continue;
      tell(mend_tangents(a), a, "were no tangents of length 1 with a sign, and are now", "/attributes/");
    }
    mend_weights();
    for (std::size_t t = 0; t < primitive_.targets.size(); ++t) {
      for (Attribute& a : primitive_.targets[t]) {
        if (a.type != ComponentType::f32) continue;
        tell(make_finite(a), a, "were infinite or no numbers, and are 0 now", "/targets/" + std::to_string(t) + "/");
      }
    }
  }

private:
  void tell(std::size_t count, const Attribute& a, const std::string& what, const std::string& place) {
    if (count == 0) return;
    notes_.push_back(
        {"attribute-mended", std::to_string(count) + " values of " + a.name + " " + what, where_ + place + a.name});
  }

  static std::size_t make_finite(Attribute& a) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.count(); ++v) {
      bool is_finite = true;
      for (std::uint32_t c = 0; c < a.components; ++c) {
        if (std::isfinite(a.get(v, c))) continue;
        a.set(v, c, 0);
        is_finite = false;
      }
      if (!is_finite) ++count;
    }
    return count;
  }

  std::size_t mend_normals(Attribute& a) {
    std::size_t count = 0;
    std::vector<Vec3d> of_surface;
    for (std::size_t v = 0; v < a.count(); ++v) {
      Vec3d n = vector_at(a, v);
      if (is_unit(n)) continue;
      ++count;
      if (!(norm(n) > 0)) {
        if (of_surface.empty()) of_surface = surface_normals(primitive_);
        n = of_surface[v];
      }
      set_vector(a, v, norm(n) > 0 ? normalized(n) : Vec3d{0, 0, 1});
    }
    return count;
  }

  std::size_t mend_tangents(Attribute& a) {
    const Attribute* normal = primitive_.find("NORMAL");
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.count(); ++v) {
      const Vec3d t = vector_at(a, v);
      const double sign = a.get(v, 3);
      if (is_unit(t) && std::abs(sign) == 1) continue;
      ++count;
      set_vector(a, v, norm(t) > 0 ? normalized(t) : across(normal ? vector_at(*normal, v) : Vec3d{0, 0, 1}));
      a.set(v, 3, sign < 0 ? -1 : 1);
    }
    return count;
  }

  static std::size_t clamp(Attribute& a) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.count(); ++v) {
      bool was_inside = true;
      for (std::uint32_t c = 0; c < a.components; ++c) {
        const double value = a.get(v, c);
        if (value >= 0 && value <= 1) continue;
        a.set(v, c, std::clamp(value, 0.0, 1.0));
        was_inside = false;
      }
      if (!was_inside) ++count;
    }
    return count;
  }

  // All sets of a vertex together make up its sum. Normalized integers are left alone.
  void mend_weights() {
    std::vector<Attribute*> sets;
    for (Attribute& a : primitive_.attributes) {
      if (is_of(a, "WEIGHTS")) sets.push_back(&a);
    }
    if (sets.empty() || !std::ranges::all_of(sets, [](const Attribute* a) { return a->type == ComponentType::f32; }))
      return;
    std::size_t count = 0;
    for (std::size_t v = 0; v < sets.front()->count(); ++v) {
      if (!mend_weights_of(v, sets)) ++count;
    }
    tell(count, *sets.front(), "did not sum to 1 over a vertex' joints, and do now", "/attributes/");
  }

  // Whether they were right.
  static bool mend_weights_of(std::size_t v, const std::vector<Attribute*>& sets) {
    double sum = 0;
    bool is_right = true;
    for (Attribute* a : sets) {
      for (std::uint32_t c = 0; c < a->components; ++c) {
        is_right = is_right && a->get(v, c) >= 0;
        sum += std::max(a->get(v, c), 0.0);
      }
    }
    if (is_right && std::abs(sum - 1) <= sum_tolerance) return true;
    for (Attribute* a : sets) {
      for (std::uint32_t c = 0; c < a->components; ++c) a->set(v, c, sum > 0 ? std::max(a->get(v, c), 0.0) / sum : 0);
    }
    if (!(sum > 0)) sets.front()->set(v, 0, 1);
    return false;
  }

  Primitive& primitive_;
  std::vector<Asset::Note>& notes_;
  std::string where_;
};

} // namespace

void mend_attributes(Primitive& primitive, std::vector<Asset::Note>& notes) { Mender(primitive, notes).run(); }

} // namespace orbis::asset
