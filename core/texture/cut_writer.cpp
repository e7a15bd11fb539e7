#include "core/texture/cut_writer.h"

#include <algorithm>

namespace orbis::texture {
namespace {

using mesh::Index;
using mesh::Triangle;

std::size_t input_vertices(std::span<const Triangle> corners) {
  Index highest = 0;
  for (const Triangle& t : corners) highest = std::max({highest, t[0], t[1], t[2]});
  return std::size_t{highest} + 1;
}

// Triangles that only close holes have no input vertices: their own ones stand for them, numbered behind.
std::vector<Triangle> all_corners(const AtlasComponent& component) {
  std::vector<Triangle> corners(component.corners.begin(), component.corners.end());
  const auto first = static_cast<Index>(input_vertices(corners));
  for (std::size_t t = corners.size(); t < component.triangles.size(); ++t) {
    const auto& [a, b, c] = component.triangles[t];
    corners.push_back({first + a, first + b, first + c});
  }
  return corners;
}

} // namespace

CutWriter::CutWriter(const AtlasComponent& component, std::size_t points, std::size_t divided)
    : component_(component), corners_(all_corners(component)), at_input_(input_vertices(corners_), none),
      at_added_(points - component.sphere.size(), none) {
  mesh_.points = points;
  mesh_.cut_triangles = divided;
  const std::size_t expected = component.triangles.size() + 4 * divided;
  mesh_.vertices.reserve(std::min(at_input_.size(), 3 * corners_.size()) + 4 * divided);
  mesh_.triangles.reserve(expected);
  mesh_.parent.reserve(expected);
  mesh_.chart.reserve(expected);
}

void CutWriter::whole(std::uint32_t triangle, Face face) {
  Triangle vertices{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Index point = component_.triangles[triangle][k], input = corners_[triangle][k];
    CutVertex v{triangle, {}, component_.sphere[point], {}, point};
    v.barycentric[k] = 1;
    vertices[k] = vertex(v, face, input, input);
  }
  append(vertices, triangle, face);
}

void CutWriter::pieces(std::uint32_t triangle, const Division& division) {
  for (const auto& [points, face] : division.pieces) {
    Triangle vertices{};
    for (std::size_t k = 0; k < 3; ++k) {
      const DividedPoint& p = division.points[points[k]];
      const auto [a, b] = input_edge(triangle, p.site);
      vertices[k] = vertex({triangle, p.barycentric, p.sphere, {}, p.point}, face, a, b);
    }
    append(vertices, triangle, face);
  }
}

WrittenCharts CutWriter::take() {
  WrittenCharts out;
  FlatCharts& charts = out.charts;
  charts.mesh = std::move(mesh_);
  std::vector<std::uint32_t> first(charts.mesh.points, none), next; // point -> its places, a chain
  for (std::uint32_t v = 0; v < charts.mesh.vertices.size(); ++v) {
    const std::uint32_t point = charts.mesh.vertices[v].point;
    const Face face = copies_[v].face;
    std::uint32_t place = first[point];
    while (place != none && out.face[place] != face) place = next[place];
    if (place == none) {
      place = static_cast<std::uint32_t>(charts.places.size());
      charts.places.emplace_back();
      next.push_back(std::exchange(first[point], place));
      out.face.push_back(face);
      out.vertex.push_back(v);
    }
    charts.place_of.push_back(place);
  }
  for (std::size_t t = 0; t < charts.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = charts.mesh.triangles[t];
    charts.triangles.push_back({charts.place_of[a], charts.place_of[b], charts.place_of[c]});
    for (const Index p : charts.triangles.back()) charts.places[p].chart = charts.mesh.chart[t];
  }
  return out;
}

// The input vertices at the ends of the edge that a point lies on; equal at a corner and inside.
std::pair<Index, Index> CutWriter::input_edge(std::uint32_t t, Site site) const {
  const auto k = static_cast<std::size_t>(site);
  const Triangle& corners = corners_[t];
  if (site == Site::inside) return {corners[0], corners[0]};
  if (site < Site::edge_01) return {corners[k], corners[k]};
  return {corners[k - 3], corners[(k - 2) % 3]};
}

// One input vertex can be two points: where the surface was cut open.
Index CutWriter::vertex(const CutVertex& v, Face face, Index a, Index b) {
  if (a > b) std::swap(a, b);
  const std::size_t given = component_.sphere.size();
  std::uint32_t& first = v.point < given ? at_input_[a] : at_added_[v.point - given];
  for (std::uint32_t i = first; i != none; i = copies_[i].next)
    if (copies_[i].face == face && copies_[i].a == a && copies_[i].b == b && mesh_.vertices[i].point == v.point)
      return i;
  const auto made = static_cast<Index>(mesh_.vertices.size());
  mesh_.vertices.push_back(v);
  copies_.push_back({first, a, b, face});
  first = made;
  return made;
}

void CutWriter::append(const Triangle& vertices, std::uint32_t parent, Face face) {
  if (chart_of_[face] == none) {
    chart_of_[face] = static_cast<std::uint32_t>(mesh_.charts.size());
    mesh_.charts.emplace_back();
  }
  mesh_.triangles.push_back(vertices);
  mesh_.parent.push_back(parent);
  mesh_.chart.push_back(chart_of_[face]);
}

} // namespace orbis::texture
