#include "core/steps/surface.h"

#include <algorithm>

namespace orbis {
namespace {

struct Row {
  std::vector<Vec3f> positions;
  std::vector<mesh::Triangle> triangles;
  std::vector<std::uint32_t> primitive_of;
  std::vector<std::uint32_t> first_vertex;
};

// All primitives behind one another.
Row put_in_a_row(const asset::Asset& asset) {
  Row row;
  for (std::uint32_t p = 0; p < asset.primitives.size(); ++p) {
    const asset::Primitive& primitive = asset.primitives[p];
    const auto first = static_cast<std::uint32_t>(row.positions.size());
    row.first_vertex.push_back(first);
    const std::vector<Vec3f> positions = primitive.positions();
    row.positions.insert(row.positions.end(), positions.begin(), positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      row.triangles.push_back(
          {first + primitive.indices[i], first + primitive.indices[i + 1], first + primitive.indices[i + 2]});
      row.primitive_of.push_back(p);
    }
  }
  return row;
}

// Vertices that a sphere of this many triangles has (Euler).
std::size_t vertices_of_sphere(std::size_t triangles) { return triangles / 2 + 2; }

// Indices first: where they alone describe a sphere, coincident vertices are different points of it.
mesh::Welded join_vertices(const Row& row, mesh::Topology& topology) {
  mesh::Welded joined = mesh::keep_indices(row.positions, row.triangles);
  if (joined.mesh.positions.size() == vertices_of_sphere(row.triangles.size())) {
    topology = mesh::classify(joined.mesh);
    if (topology.is_sphere()) return joined;
  }
  joined = mesh::weld(row.positions, row.triangles);
  topology = mesh::classify(joined.mesh);
  return joined;
}

std::string counted(std::uint64_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

void check_extent(const mesh::TriangleMesh& mesh) {
  const bool point = std::ranges::all_of(mesh.positions, [&](const Vec3f& p) { return p == mesh.positions.front(); });
  if (point)
    throw Error(ErrorCode::invalid_geometry, "all vertices of the surface are at one position: it has no extent");
}

} // namespace

Surface make_surface(const asset::Asset& asset, Report& report) {
  Row row = put_in_a_row(asset);
  report.input_triangles = row.triangles.size();
  report.input_vertices = row.positions.size();
  mesh::Welded joined = join_vertices(row, report.topology);
  report.degenerate_triangles = joined.degenerate.size();
  if (!joined.mesh.positions.empty()) check_extent(joined.mesh);
  if (!report.topology.is_sphere()) throw Error(ErrorCode::not_genus_zero, report.topology.refusal());

  Surface out;
  out.mesh = std::move(joined.mesh);
  out.vertex_of = std::move(joined.vertex_of);
  out.first_vertex = std::move(row.first_vertex);
  for (const std::uint32_t t : joined.triangle_of) {
    out.corners.push_back(row.triangles[t]);
    out.primitive_of.push_back(row.primitive_of[t]);
  }
  const std::vector<std::uint32_t> turned = mesh::orient_consistently(out.mesh);
  for (const std::uint32_t t : turned) std::swap(out.corners[t][1], out.corners[t][2]);
  report.turned_triangles = turned.size();

  if (report.degenerate_triangles > 0) {
    report.notes.push_back({"degenerate-triangles",
                            counted(report.degenerate_triangles, "triangle") +
                                " without area left out: two of the corners are at one position",
                            ""});
  }
  if (!turned.empty()) {
    report.notes.push_back(
        {"turned-triangles", counted(turned.size(), "triangle") + " turned to agree with the neighbours", ""});
  }
  const auto unused = std::ranges::count(out.vertex_of, mesh::unreferenced);
  if (unused > 0) {
    report.notes.push_back(
        {"unused-vertices",
         counted(static_cast<std::uint64_t>(unused), "unused vertex") + " left out: no triangle uses it", ""});
  }
  if (report.topology.signed_volume < 0 && turned.empty()) {
    report.notes.push_back({"inside-out", "the surface is inside out and was kept so: its triangles face inward", ""});
  }
  return out;
}

} // namespace orbis
