#include "core/steps/surface.h"

#include <algorithm>

#include "core/mesh/disjoint_sets.h"

namespace orbis {
namespace {

// The primitives of one mesh of the document, behind one another.
struct Row {
  std::uint32_t mesh = 0;
  std::uint32_t first_vertex = 0; // in the row of all meshes
  std::vector<Vec3f> positions;
  std::vector<mesh::Triangle> triangles; // indices into positions
  std::vector<std::uint32_t> primitive_of;
};

// One row per mesh of the document. Fills surface.first_vertex.
std::vector<Row> rows_of(const asset::Asset& asset, Surface& surface) {
  std::vector<Row> rows;
  std::uint32_t vertices = 0;
  for (std::uint32_t p = 0; p < asset.primitives.size(); ++p) {
    const asset::Primitive& primitive = asset.primitives[p];
    if (rows.empty() || rows.back().mesh != primitive.mesh) rows.push_back({primitive.mesh, vertices, {}, {}, {}});
    Row& row = rows.back();
    surface.first_vertex.push_back(vertices);
    const auto first = static_cast<std::uint32_t>(row.positions.size());
    const std::vector<Vec3f> positions = primitive.positions();
    row.positions.insert(row.positions.end(), positions.begin(), positions.end());
    vertices += static_cast<std::uint32_t>(positions.size());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      row.triangles.push_back(
          {first + primitive.indices[i], first + primitive.indices[i + 1], first + primitive.indices[i + 2]});
      row.primitive_of.push_back(p);
    }
  }
  return rows;
}

// Indices first: where they alone describe closed surfaces, coincident vertices are different points of them.
mesh::Welded join_vertices(const Row& row) {
  mesh::Welded joined = mesh::keep_indices(row.positions, row.triangles);
  const mesh::Topology found = mesh::classify(joined.mesh);
  if (found.boundary_edges == 0 && found.nonmanifold_edges == 0 && found.nonmanifold_vertices == 0) return joined;
  return mesh::weld(row.positions, row.triangles);
}

// The triangles by component, components by their first triangle.
std::vector<std::vector<std::uint32_t>> by_component(const mesh::TriangleMesh& mesh) {
  mesh::DisjointSets sets(mesh.positions.size());
  for (const mesh::Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
  }
  std::vector<std::uint32_t> number(mesh.positions.size(), no_primitive);
  std::vector<std::vector<std::uint32_t>> out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& n = number[sets.find(mesh.triangles[t][0])];
    if (n == no_primitive) {
      n = static_cast<std::uint32_t>(out.size());
      out.emplace_back();
    }
    out[n].push_back(t);
  }
  return out;
}

std::string counted(std::uint64_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

void check_extent(const mesh::TriangleMesh& mesh) {
  const bool point = std::ranges::all_of(mesh.positions, [&](const Vec3f& p) { return p == mesh.positions.front(); });
  if (point)
    throw Error(ErrorCode::invalid_geometry, "all vertices of the surface are at one position: it has no extent");
}

// Appends the components of one mesh of the document to the surface.
class Collector {
public:
  Collector(const Row& row, Report& report, Surface& out)
      : row_(row), report_(report), out_(out), joined_(join_vertices(row)) {}

  void run() {
    report_.degenerate_triangles += joined_.degenerate.size();
    if (!joined_.mesh.positions.empty()) check_extent(joined_.mesh);
    place_.assign(joined_.mesh.positions.size(), no_primitive);
    for (const auto& triangles : by_component(joined_.mesh)) add(triangles);
  }

private:
  void add(std::span<const std::uint32_t> triangles) {
    Component c;
    c.mesh = row_.mesh;
    c.first_vertex = static_cast<std::uint32_t>(out_.mesh.positions.size());
    c.first_triangle = static_cast<std::uint32_t>(out_.mesh.triangles.size());
    c.triangles = c.input_triangles = static_cast<std::uint32_t>(triangles.size());
    mesh::TriangleMesh piece;
    for (const std::uint32_t t : triangles) {
      mesh::Triangle placed{};
      for (std::size_t k = 0; k < 3; ++k) placed[k] = place(joined_.mesh.triangles[t][k], piece);
      piece.triangles.push_back(placed);
      const mesh::Triangle& corners = row_.triangles[joined_.triangle_of[t]];
      out_.corners.push_back(
          {row_.first_vertex + corners[0], row_.first_vertex + corners[1], row_.first_vertex + corners[2]});
      out_.primitive_of.push_back(row_.primitive_of[joined_.triangle_of[t]]);
    }
    report_.topology = mesh::classify(piece);
    if (!report_.topology.is_sphere()) throw Error(ErrorCode::not_genus_zero, report_.topology.refusal());
    const std::vector<std::uint32_t> turned = mesh::orient_consistently(piece);
    for (const std::uint32_t t : turned) {
      mesh::Triangle& corners = out_.corners[c.first_triangle + t];
      std::swap(corners[1], corners[2]);
    }
    report_.turned_triangles += turned.size();
    out_.mesh.positions.insert(out_.mesh.positions.end(), piece.positions.begin(), piece.positions.end());
    for (const auto& [i, j, k] : piece.triangles) {
      out_.mesh.triangles.push_back({c.first_vertex + i, c.first_vertex + j, c.first_vertex + k});
    }
    c.vertices = c.input_vertices = static_cast<std::uint32_t>(piece.positions.size());
    out_.components.push_back(c);
  }

  mesh::Index place(mesh::Index v, mesh::TriangleMesh& piece) {
    if (place_[v] == no_primitive) {
      place_[v] = static_cast<mesh::Index>(piece.positions.size());
      piece.positions.push_back(joined_.mesh.positions[v]);
    }
    return place_[v];
  }

  const Row& row_;
  Report& report_;
  Surface& out_;
  mesh::Welded joined_;
  std::vector<mesh::Index> place_; // welded vertex -> vertex of its component
};

mesh::TriangleMesh piece_of(const Surface& surface, const Component& c, std::uint32_t vertices,
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

} // namespace

mesh::TriangleMesh mesh_of(const Surface& surface, const Component& c) {
  return piece_of(surface, c, c.vertices, c.triangles);
}

mesh::TriangleMesh input_mesh_of(const Surface& surface, const Component& c) {
  return piece_of(surface, c, c.input_vertices, c.input_triangles);
}

Surface make_surface(const asset::Asset& asset, Report& report) {
  Surface out;
  const std::vector<Row> rows = rows_of(asset, out);
  for (const Row& row : rows) {
    report.input_triangles += row.triangles.size();
    report.input_vertices += row.positions.size();
    Collector(row, report, out).run();
  }
  if (out.components.empty()) throw Error(ErrorCode::not_genus_zero, mesh::classify({}).refusal());
  report.topology.components = static_cast<std::uint32_t>(out.components.size());
  report.topology.vertices = out.mesh.positions.size();
  report.topology.triangles = out.mesh.triangles.size();
  if (report.degenerate_triangles > 0) {
    report.notes.push_back({"degenerate-triangles",
                            counted(report.degenerate_triangles, "triangle") +
                                " without area left out: two of the corners are at one position",
                            ""});
  }
  if (report.turned_triangles > 0) {
    report.notes.push_back({"turned-triangles",
                            counted(report.turned_triangles, "triangle") + " turned to agree with the neighbours", ""});
  }
  if (report.topology.signed_volume < 0 && report.turned_triangles == 0) {
    report.notes.push_back({"inside-out", "the surface is inside out and was kept so: its triangles face inward", ""});
  }
  return out;
}

} // namespace orbis
