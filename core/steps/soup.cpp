#include "core/steps/soup.h"

#include <algorithm>
#include <tuple>

#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace orbis {
namespace {

// The primitives of one mesh of the document, behind one another.
struct Row {
  std::uint32_t first_vertex = 0; // in the row of all meshes
  std::vector<Vec3f> positions;
  std::vector<mesh::Triangle> triangles; // indices into positions
  std::vector<std::uint32_t> primitive_of;
};

Row row_of(const asset::Asset& asset, std::uint32_t first_primitive, std::uint32_t end, Soup& soup) {
  Row row;
  row.first_vertex = static_cast<std::uint32_t>(soup.input_vertices);
  for (std::uint32_t p = first_primitive; p < end; ++p) {
    const asset::Primitive& primitive = asset.primitives[p];
    const auto first = static_cast<std::uint32_t>(row.positions.size());
    soup.first_vertex.push_back(row.first_vertex + first);
    const std::vector<Vec3f> positions = primitive.positions();
    row.positions.insert(row.positions.end(), positions.begin(), positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      row.triangles.push_back(
          {first + primitive.indices[i], first + primitive.indices[i + 1], first + primitive.indices[i + 2]});
      row.primitive_of.push_back(p);
    }
  }
  soup.input_vertices += row.positions.size();
  soup.input_triangles += row.triangles.size();
  return row;
}

// Indices first: where they alone describe closed surfaces, coincident vertices are different points of them.
mesh::Welded join_vertices(const Row& row, double tolerance) {
  if (tolerance > 0) return mesh::weld_within(row.positions, row.triangles, tolerance);
  mesh::Welded joined = mesh::keep_indices(row.positions, row.triangles);
  const mesh::Topology found = mesh::classify(joined.mesh);
  if (found.boundary_edges == 0 && found.nonmanifold_edges == 0 && found.nonmanifold_vertices == 0) return joined;
  return mesh::weld(row.positions, row.triangles);
}

mesh::Triangle plus(const mesh::Triangle& t, std::uint32_t n) { return {t[0] + n, t[1] + n, t[2] + n}; }

void append(const Row& row, const mesh::Welded& joined, Soup& soup) {
  const auto first = static_cast<mesh::Index>(soup.mesh.positions.size());
  soup.mesh.positions.insert(soup.mesh.positions.end(), joined.mesh.positions.begin(), joined.mesh.positions.end());
  for (std::size_t i = 0; i < joined.triangle_of.size(); ++i) {
    const std::uint32_t t = joined.triangle_of[i];
    soup.mesh.triangles.push_back(plus(joined.mesh.triangles[i], first));
    soup.corners.push_back(plus(row.triangles[t], row.first_vertex));
    soup.primitive_of.push_back(row.primitive_of[t]);
  }
  for (const std::uint32_t t : joined.degenerate) {
    LooseTriangle loose{row.primitive_of[t], plus(row.triangles[t], row.first_vertex), {}};
    for (std::size_t k = 0; k < 3; ++k) loose.points[k] = first + joined.vertex_of[row.triangles[t][k]];
    soup.degenerate.push_back(loose);
  }
  soup.unused_vertices += static_cast<std::uint64_t>(std::ranges::count(joined.vertex_of, mesh::unreferenced));
}

// A triangle by what makes it a duplicate of another one: its points from the lowest on, in their direction.
struct Key {
  mesh::Triangle points{};
  std::uint32_t material = 0; // 0: none
  std::uint32_t triangle = 0;

  [[nodiscard]] bool is_like(const Key& other) const { return points == other.points && material == other.material; }
  auto operator<=>(const Key&) const = default;
};

mesh::Triangle from_lowest(mesh::Triangle t) {
  std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  return t;
}

std::vector<Key> sorted_keys(const asset::Asset& asset, const Soup& soup) {
  std::vector<Key> keys;
  keys.reserve(soup.mesh.triangles.size());
  for (std::uint32_t t = 0; t < soup.mesh.triangles.size(); ++t) {
    const auto& material = asset.primitives[soup.primitive_of[t]].material;
    keys.push_back({from_lowest(soup.mesh.triangles[t]), material ? *material + 1 : 0, t});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

template <class T> void keep(std::vector<T>& values, const std::vector<std::uint32_t>& original) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < original.size(); ++t) {
    if (original[t] == t) values[kept++] = values[t];
  }
  values.resize(kept);
}

} // namespace

Soup make_soup(const asset::Asset& asset, double weld_tolerance) {
  Soup soup;
  const auto count = static_cast<std::uint32_t>(asset.primitives.size());
  for (std::uint32_t first = 0, end = 0; first < count; first = end) {
    while (end < count && asset.primitives[end].mesh == asset.primitives[first].mesh) ++end;
    const Row row = row_of(asset, first, end, soup);
    append(row, join_vertices(row, weld_tolerance), soup);
  }
  return soup;
}

std::vector<Duplicate> take_duplicates(const asset::Asset& asset, Soup& soup) {
  const std::vector<Key> keys = sorted_keys(asset, soup);
  std::vector<std::uint32_t> original(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    // The first of its kind has the lowest number.
    const bool again = i > 0 && keys[i].is_like(keys[i - 1]);
    original[keys[i].triangle] = again ? original[keys[i - 1].triangle] : keys[i].triangle;
  }
  std::vector<Duplicate> out;
  std::vector<std::uint32_t> number(original.size(), 0); // of the triangles that stay
  std::uint32_t kept = 0;
  for (std::uint32_t t = 0; t < original.size(); ++t) {
    number[t] = kept;
    if (original[t] == t) {
      ++kept;
    } else {
      out.push_back({{soup.primitive_of[t], soup.corners[t], soup.mesh.triangles[t]}, number[original[t]]});
    }
  }
  if (out.empty()) return out;
  keep(soup.mesh.triangles, original);
  keep(soup.corners, original);
  keep(soup.primitive_of, original);
  return out;
}

} // namespace orbis
