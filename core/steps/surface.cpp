#include "core/steps/surface.h"

#include <algorithm>

#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/steps/leave_out.h"
#include "core/steps/repair_notes.h"
#include "core/steps/soup.h"

namespace orbis {
namespace {

mesh::TriangleMesh part_of(const Surface& surface, const Component& c, std::uint32_t vertices,
                           std::uint32_t triangles) {
  mesh::TriangleMesh out;
  const auto position = surface.mesh.positions.begin() + c.first_vertex;
  out.positions.assign(position, position + vertices);
  out.triangles.reserve(triangles);
  for (const auto& [i, j, k] : std::span(surface.mesh.triangles).subspan(c.first_triangle, triangles)) {
    out.triangles.push_back({i - c.first_vertex, j - c.first_vertex, k - c.first_vertex});
  }
  return out;
}

// What is a sphere already needs no repair but to agree with itself.
mesh::Repaired as_it_is(mesh::TriangleMesh& mesh) {
  mesh::Repaired out;
  const std::vector<std::uint32_t> turned = mesh::orient_consistently(mesh);
  out.turned.assign(mesh.triangles.size(), false);
  for (const std::uint32_t t : turned) out.turned[t] = true;
  out.triangle_of.resize(mesh.triangles.size());
  for (std::uint32_t t = 0; t < out.triangle_of.size(); ++t) out.triangle_of[t] = t;
  out.point_of.resize(mesh.positions.size());
  for (std::uint32_t v = 0; v < out.point_of.size(); ++v) out.point_of[v] = v;
  mesh::ClosedPiece piece;
  piece.vertices = piece.soup_vertices = static_cast<std::uint32_t>(mesh.positions.size());
  piece.triangles = piece.soup_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  piece.turned_triangles = static_cast<std::uint32_t>(turned.size());
  out.pieces.push_back(piece);
  out.mesh = std::move(mesh);
  return out;
}

mesh::Triangle turned(const mesh::Triangle& t) { return {t[0], t[2], t[1]}; }

class Assembly {
public:
  Assembly(const asset::Asset& asset, Soup soup, Report& report)
      : asset_(asset), soup_(std::move(soup)), report_(report) {}

  Surface run() {
    const bool is_sphere = report_.topology.is_sphere();
    const bool may_have_duplicates = report_.topology.nonmanifold_edges > 0 || !report_.topology.consistently_oriented;
    if (!is_sphere && may_have_duplicates) duplicates_ = take_duplicates(asset_, soup_);
    repaired_ = is_sphere ? as_it_is(soup_.mesh)
                          : mesh::repair(soup_.mesh.positions, soup_.mesh.triangles, soup_.corners,
                                         report_.options.weld_tolerance);
    place_triangles();
    place_components();
    place_duplicates();
    place_degenerate();
    out_.mesh = std::move(repaired_.mesh);
    out_.first_vertex = std::move(soup_.first_vertex);
    return std::move(out_);
  }

private:
  void place_triangles() {
    surface_triangle_.assign(soup_.corners.size(), no_primitive);
    for (std::uint32_t t = 0; t < repaired_.triangle_of.size(); ++t) {
      const std::uint32_t source = repaired_.triangle_of[t];
      if (source == mesh::added_triangle) {
        out_.corners.push_back({no_primitive, no_primitive, no_primitive});
        out_.primitive_of.push_back(no_primitive);
        continue;
      }
      surface_triangle_[source] = t;
      out_.corners.push_back(repaired_.turned[source] ? turned(soup_.corners[source]) : soup_.corners[source]);
      out_.primitive_of.push_back(soup_.primitive_of[source]);
    }
  }

  void place_components() {
    for (const mesh::ClosedPiece& p : repaired_.pieces) {
      const std::uint32_t mesh = asset_.primitives[out_.primitive_of[p.first_triangle]].mesh;
      const auto number = static_cast<std::uint32_t>(out_.components.size());
      out_.components.push_back(
          {p.first_vertex, p.vertices, p.soup_vertices, p.first_triangle, p.triangles, p.soup_triangles, mesh, number});
      ComponentReport facts;
      facts.mesh = mesh;
      facts.triangles = p.soup_triangles;
      facts.vertices = p.soup_vertices;
      facts.genus = p.genus;
      facts.boundary_loops = p.boundary_loops;
      facts.boundary_edges = p.boundary_edges;
      facts.turned_triangles = p.turned_triangles;
      facts.crack_triangles = p.crack_triangles;
      facts.cap_triangles = p.triangles - p.soup_triangles - p.crack_triangles;
      facts.handles = p.handles.loops;
      facts.handle_cut_edges = p.handles.edges;
      facts.handle_cut_length = p.handles.length;
      report_.components.push_back(std::move(facts));
      add_up(report_.components.back(), p.caps);
    }
    Repairs& sum = report_.repairs;
    sum.degenerate_triangles = soup_.degenerate.size();
    sum.duplicate_triangles = duplicates_.size();
    sum.shared_edges = repaired_.counts.shared_edges;
    sum.double_edges = repaired_.counts.double_edges;
    sum.split_vertices = repaired_.counts.split_vertices;
    sum.one_sided_edges = repaired_.counts.one_sided_edges;
    sum.internal_triangles = repaired_.counts.internal_triangles;
  }

  void add_up(const ComponentReport& component, std::uint32_t caps) {
    Repairs& sum = report_.repairs;
    sum.turned_triangles += component.turned_triangles;
    sum.crack_triangles += component.crack_triangles;
    sum.capped_loops += caps;
    sum.handles += component.handles;
    sum.handle_cut_edges += component.handle_cut_edges;
    sum.handle_cut_length += component.handle_cut_length;
  }

  // Turned and rotated as its twin is, so that corner lies on corner.
  void place_duplicates() {
    for (const Duplicate& d : duplicates_) {
      const mesh::Triangle& points = soup_.mesh.triangles[d.original];
      const auto shift =
          static_cast<std::size_t>(std::ranges::find(d.triangle.points, points[0]) - d.triangle.points.begin());
      mesh::Triangle corners{};
      for (std::size_t k = 0; k < 3; ++k) corners[k] = d.triangle.corners[(k + shift) % 3];
      if (repaired_.turned[d.original]) corners = turned(corners);
      out_.riders.push_back({d.triangle.primitive, corners, surface_triangle_[d.original]});
    }
  }

  void place_degenerate() {
    if (soup_.degenerate.empty()) return;
    std::vector<std::uint32_t> at(repaired_.point_of.size(), no_primitive); // point -> vertex of the surface
    at.resize(std::max(at.size(), points_in_use()), no_primitive);
    for (const Component& c : out_.components) {
      for (std::uint32_t v = c.first_vertex + c.input_vertices; v-- > c.first_vertex;) at[repaired_.point_of[v]] = v;
    }
    for (const LooseTriangle& t : soup_.degenerate) {
      Rider rider{t.primitive, t.corners};
      for (std::size_t k = 0; k < 3; ++k) rider.vertices[k] = at[t.points[k]];
      out_.riders.push_back(rider);
    }
  }

  [[nodiscard]] std::size_t points_in_use() const {
    std::size_t count = 0;
    for (const std::uint32_t p : repaired_.point_of)
      count = std::max(count, p == no_primitive ? 0 : std::size_t{p} + 1);
    for (const LooseTriangle& t : soup_.degenerate)
      count = std::max(count, std::size_t{std::ranges::max(t.points)} + 1);
    return count;
  }

  const asset::Asset& asset_;
  Soup soup_;
  Report& report_;
  std::vector<Duplicate> duplicates_;
  mesh::Repaired repaired_;
  std::vector<std::uint32_t> surface_triangle_; // triangle of the soup -> triangle of the surface
  Surface out_;
};

bool has_extent(const Surface& surface, const Component& c) {
  const auto positions = std::span(surface.mesh.positions).subspan(c.first_vertex, c.input_vertices);
  return std::ranges::any_of(positions, [&](const Vec3f& p) { return !(p == positions.front()); });
}

void leave_out_points(Surface& surface, Report& report) {
  if (surface.components.empty()) {
    throw Error(ErrorCode::invalid_geometry,
                "all triangles are degenerate: each has two corners at one position, so there is no surface");
  }
  Problems problems;
  for (std::uint32_t i = 0; i < surface.components.size(); ++i) {
    const Component& c = surface.components[i];
    if (has_extent(surface, c)) continue;
    problems[i] = {"no-extent", "all vertices of the component are at one position",
                   "/meshes/" + std::to_string(c.mesh)};
  }
  if (problems.size() == surface.components.size()) {
    throw Error(ErrorCode::invalid_geometry, "all vertices of the surface are at one position: it has no extent");
  }
  std::vector<Vec3d> no_points;
  leave_out(problems, surface, no_points, report);
}

} // namespace

mesh::TriangleMesh mesh_of(const Surface& surface, const Component& c) {
  return part_of(surface, c, c.vertices, c.triangles);
}

mesh::TriangleMesh input_mesh_of(const Surface& surface, const Component& c) {
  return part_of(surface, c, c.input_vertices, c.input_triangles);
}

Surface make_surface(const asset::Asset& asset, Report& report) {
  Soup soup = make_soup(asset, report.options.weld_tolerance);
  report.input_triangles = soup.input_triangles;
  report.input_vertices = soup.input_vertices;
  report.topology = mesh::classify(soup.mesh);
  const std::uint64_t unused = soup.unused_vertices;
  if (report.options.topology == TopologyPolicy::strict && !report.topology.is_sphere()) {
    throw Error(ErrorCode::not_genus_zero, report.topology.refusal());
  }
  Surface out = Assembly(asset, std::move(soup), report).run();
  leave_out_points(out, report);
  note_repairs(unused, report);
  return out;
}

} // namespace orbis
