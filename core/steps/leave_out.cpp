#include "core/steps/leave_out.h"

namespace orbis {
namespace {

// The surface with the components that stay, their vertices and triangles in the old order.
class Rest {
public:
  Rest(const Problems& problems, Surface& surface, std::vector<Vec3d>& points)
      : surface_(surface), points_(points), vertex_(surface.mesh.positions.size(), no_primitive),
        triangle_(surface.mesh.triangles.size(), no_primitive) {
    std::vector<Component> kept;
    for (std::uint32_t i = 0; i < surface.components.size(); ++i) {
      if (problems.contains(i)) {
        ride(surface.components[i]);
      } else {
        kept.push_back(move_up(surface.components[i]));
      }
    }
    surface.components = std::move(kept);
    surface.mesh.positions.resize(vertices_);
    if (!points.empty()) points.resize(vertices_);
    surface.mesh.triangles.resize(triangles_);
    surface.corners.resize(triangles_);
    surface.primitive_of.resize(triangles_);
    rename_in_riders();
  }

private:
  void ride(const Component& c) {
    for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.input_triangles; ++t) {
      surface_.riders.push_back({surface_.primitive_of[t], surface_.corners[t]});
    }
  }

  // To the front, over what was left out.
  Component move_up(Component c) {
    const std::uint32_t first_vertex = vertices_, first_triangle = triangles_;
    for (std::uint32_t v = c.first_vertex; v < c.end_vertex(); ++v) {
      vertex_[v] = vertices_;
      surface_.mesh.positions[vertices_] = surface_.mesh.positions[v];
      if (!points_.empty()) points_[vertices_] = points_[v];
      ++vertices_;
    }
    for (std::uint32_t t = c.first_triangle; t < c.end_triangle(); ++t) {
      triangle_[t] = triangles_;
      for (std::size_t k = 0; k < 3; ++k) {
        surface_.mesh.triangles[triangles_][k] = vertex_[surface_.mesh.triangles[t][k]];
      }
      surface_.corners[triangles_] = surface_.corners[t];
      surface_.primitive_of[triangles_] = surface_.primitive_of[t];
      ++triangles_;
    }
    c.first_vertex = first_vertex;
    c.first_triangle = first_triangle;
    return c;
  }

  void rename_in_riders() {
    for (Rider& rider : surface_.riders) {
      if (rider.twin != no_primitive) rider.twin = triangle_[rider.twin];
      for (mesh::Index& v : rider.vertices) {
        if (v != no_primitive) v = vertex_[v];
      }
    }
  }

  Surface& surface_;
  std::vector<Vec3d>& points_;
  std::vector<std::uint32_t> vertex_, triangle_; // old -> new, or no_primitive
  std::uint32_t vertices_ = 0, triangles_ = 0;
};

} // namespace

void leave_out(const Problems& problems, Surface& surface, std::vector<Vec3d>& points, Report& report) {
  if (problems.empty()) return;
  report.partial = true;
  for (const auto& [component, problem] : problems) {
    report.components[surface.components[component].number].problem = problem;
  }
  if (problems.size() == surface.components.size()) {
    const Note& first = problems.begin()->second;
    throw Error(ErrorCode::not_certified, first.message, first.where);
  }
  Rest(problems, surface, points);
}

} // namespace orbis
