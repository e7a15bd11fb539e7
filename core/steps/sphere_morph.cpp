#include "core/steps/sphere_morph.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

namespace orbis {
namespace {

using asset::Attribute;
using asset::vector_at;

struct Ball {
  Vec3d centre;
  double radius = 0;
};

Ball ball_of(const Surface& surface, const Component& c) {
  Vec3d moment;
  double area = 0;
  for (std::uint32_t t = c.first_triangle; t < c.end_triangle(); ++t) {
    const auto& [i, j, k] = surface.mesh.triangles[t];
    const Vec3d p(surface.mesh.positions[i]), q(surface.mesh.positions[j]), r(surface.mesh.positions[k]);
    const double a = norm(cross(q - p, r - p)) / 2;
    area += a;
    moment += (p + q + r) * (a / 3);
  }
  if (!(area > 0)) return {Vec3d(surface.mesh.positions[c.first_vertex]), 0};
  return {moment * (1 / area), std::sqrt(area / (4 * std::numbers::pi))};
}

Attribute differences(const char* name, std::size_t count) {
  Attribute out{name, asset::ComponentType::f32, false, 3, {}};
  out.data.resize(count * sizeof(Vec3f));
  return out;
}

void set_vector(Attribute& attribute, std::size_t v, const Vec3d& value) {
  attribute.set(v, 0, value.x);
  attribute.set(v, 1, value.y);
  attribute.set(v, 2, value.z);
}

class SphereMorph {
public:
  SphereMorph(const asset::Asset& asset, const Surface& surface, Delivery& delivery)
      : asset_(asset), surface_(surface), delivery_(delivery) {
    for (const Component& c : surface.components) balls_.push_back(ball_of(surface, c));
  }

  void run() {
    for (std::size_t p = 0; p < delivery_.primitives.size(); ++p) {
      if (!delivery_.primitives[p].indices.empty()) note_places(p);
    }
    for (std::size_t p = 0; p < delivery_.primitives.size(); ++p) {
      if (!delivery_.primitives[p].indices.empty()) add_target(p);
    }
  }

private:
  using Key = std::pair<std::uint32_t, std::array<double, 6>>; // mesh; point of the sphere, position

  // Which component each vertex belongs to, by the triangles of the surface that use it.
  void note_places(std::size_t p) {
    const asset::NewPrimitive& primitive = delivery_.primitives[p];
    const std::vector<std::uint32_t>& component = delivery_.component_of[p];
    std::vector<std::uint32_t>& of_vertex = component_of_vertex_[p];
    of_vertex.assign(primitive.attributes.front().count(), no_primitive);
    for (std::size_t t = 0; t < component.size(); ++t) {
      if (component[t] == no_primitive) continue;
      for (std::size_t k = 0; k < 3; ++k) of_vertex[primitive.indices[3 * t + k]] = component[t];
    }
    if (surface_.riders.empty()) return;
    for (std::size_t v = 0; v < of_vertex.size(); ++v) {
      if (of_vertex[v] == no_primitive) continue;
      by_place_.try_emplace(key(p, v, true), of_vertex[v]);
      by_place_.try_emplace(key(p, v, false), of_vertex[v]);
    }
  }

  [[nodiscard]] Key key(std::size_t p, std::size_t v, bool with_position) const {
    const Vec3d s = vector_at(*delivery_.primitives[p].find("_SPHERE"), v);
    const Vec3d at = with_position ? vector_at(*delivery_.primitives[p].find("POSITION"), v) : Vec3d{};
    return {asset_.primitives[p].mesh, {s.x, s.y, s.z, at.x, at.y, at.z}};
  }

  // Vertices of triangles that only ride along: that of the surface's vertex where they lie.
  [[nodiscard]] std::uint32_t component_of(std::size_t p, std::size_t v) const {
    const std::uint32_t known = component_of_vertex_.at(p)[v];
    if (known != no_primitive) return known;
    auto found = by_place_.find(key(p, v, true));
    if (found == by_place_.end()) found = by_place_.find(key(p, v, false));
    return found == by_place_.end() ? no_primitive : found->second;
  }

  void add_target(std::size_t p) {
    asset::NewPrimitive& primitive = delivery_.primitives[p];
    const Attribute &position = *primitive.find("POSITION"), &sphere = *primitive.find("_SPHERE");
    const Attribute* normal = primitive.find("NORMAL");
    Attribute moves = differences("POSITION", position.count()), turns = differences("NORMAL", position.count());
    for (std::size_t v = 0; v < position.count(); ++v) {
      const std::uint32_t c = component_of(p, v);
      if (c == no_primitive) continue;
      const Vec3d direction = vector_at(sphere, v);
      set_vector(moves, v, balls_[c].centre + direction * balls_[c].radius - vector_at(position, v));
      if (normal != nullptr) set_vector(turns, v, direction - vector_at(*normal, v));
    }
    std::vector<Attribute>& target = primitive.targets.emplace_back();
    target.push_back(std::move(moves));
    if (normal != nullptr) target.push_back(std::move(turns));
    primitive.added_target = "sphere";
  }

  const asset::Asset& asset_;
  const Surface& surface_;
  Delivery& delivery_;
  std::vector<Ball> balls_; // by component
  std::map<std::size_t, std::vector<std::uint32_t>> component_of_vertex_;
  std::map<Key, std::uint32_t> by_place_;
};

} // namespace

void add_sphere_morph(const asset::Asset& asset, const Surface& surface, Delivery& delivery) {
  SphereMorph(asset, surface, delivery).run();
}

} // namespace orbis
