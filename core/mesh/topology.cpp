// Classification of a triangle soup by counting: no half-edge structure, so any input will do.
#include "core/mesh/topology.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/edges.h"

namespace orbis::mesh {
namespace {

constexpr std::size_t most_places = 8;

std::string text_of(const Vec3f& p) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "(%.6g, %.6g, %.6g)", double{p.x}, double{p.y}, double{p.z});
  return buffer.data();
}

void add_place(Topology& out, const std::string& place) {
  if (out.where.size() < most_places) out.where.push_back(place);
}

// Does half-edge h of the triangle run from its edge's lower vertex to the higher one?
bool runs_up(std::span<const Triangle> triangles, std::uint32_t h) {
  const Triangle& t = triangles[h / 3];
  return t[h % 3] < t[(h % 3 + 1) % 3];
}

// The two corners (3 t + k) of half-edge h: at the edge's lower and at its higher vertex.
std::array<std::uint32_t, 2> corners_of(std::span<const Triangle> triangles, std::uint32_t h) {
  const std::uint32_t from = h, to = h - h % 3 + (h % 3 + 1) % 3;
  return runs_up(triangles, h) ? std::array{from, to} : std::array{to, from};
}

std::uint64_t count_duplicates(std::span<const Triangle> triangles) {
  std::vector<Triangle> sorted(triangles.begin(), triangles.end());
  for (Triangle& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t duplicates = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) duplicates += sorted[i] == sorted[i - 1] ? 1 : 0;
  return duplicates;
}

// Six times the signed volume, summed relative to the first vertex so that a distant origin costs no digits.
double signed_volume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  const Vec3d origin(mesh.positions[mesh.triangles[0][0]]);
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = Vec3d(mesh.positions[t[0]]) - origin;
    const Vec3d b = Vec3d(mesh.positions[t[1]]) - origin;
    const Vec3d c = Vec3d(mesh.positions[t[2]]) - origin;
    sum += dot(a, cross(b, c));
  }
  return sum / 6;
}

// A boundary loop is named by one of its vertices and its number of edges.
void report_loops(const TriangleMesh& mesh, DisjointSets& loops, const std::vector<Index>& boundary, Topology& out) {
  std::vector<Index> roots;
  roots.reserve(boundary.size());
  for (const Index low : boundary) roots.push_back(loops.find(low));
  std::sort(roots.begin(), roots.end());
  for (std::size_t i = 0; i < roots.size();) {
    std::size_t j = i;
    while (j < roots.size() && roots[j] == roots[i]) ++j;
    ++out.boundary_loops;
    add_place(out, "boundary loop of " + std::to_string(j - i) + " edges at " + text_of(mesh.positions[roots[i]]));
    i = j;
  }
}

// A vertex is not manifold where the triangles around it, joined across shared edges, form more than one fan.
void count_fans(const TriangleMesh& mesh, DisjointSets& fans, const std::vector<bool>& on_bad_edge, Topology& out) {
  std::vector<std::uint32_t> fan_of(mesh.positions.size(), unsigned(-1));
  std::vector<bool> split(mesh.positions.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Index v = mesh.triangles[t][k];
      const std::uint32_t fan = fans.find(3 * t + k);
      if (fan_of[v] == unsigned(-1)) fan_of[v] = fan;
      if (fan_of[v] == fan || split[v] || on_bad_edge[v]) continue;
      split[v] = true;
      ++out.nonmanifold_vertices;
      add_place(out, "vertex " + text_of(mesh.positions[v]) + " joins sheets that share nothing else");
    }
  }
}

// Orientability by a double cover: node t is a triangle as it is, node n + t the same triangle turned. Neighbours that
// agree join equal sides, others opposite ones; a triangle in one set with its own turned copy lies on a Moebius strip.
class DoubleCover {
public:
  explicit DoubleCover(std::size_t triangles) : sets_(2 * triangles), n_(static_cast<std::uint32_t>(triangles)) {}
  void join(std::uint32_t s, std::uint32_t t, bool agree) {
    sets_.unite(s, agree ? t : n_ + t);
    sets_.unite(n_ + s, agree ? n_ + t : t);
  }
  [[nodiscard]] bool orientable() {
    for (std::uint32_t t = 0; t < n_; ++t) {
      if (sets_.find(t) == sets_.find(n_ + t)) return false;
    }
    return true;
  }
  // Must triangle t be turned to agree with the first triangle of its component?
  [[nodiscard]] bool turned(std::uint32_t t) { return sets_.find(t) > sets_.find(n_ + t); }

private:
  DisjointSets sets_;
  std::uint32_t n_;
};

bool agree(std::span<const Triangle> triangles, std::span<const EdgeSide> pair) {
  return runs_up(triangles, pair[0].half_edge) != runs_up(triangles, pair[1].half_edge);
}

DoubleCover cover_of(const TriangleMesh& mesh, const EdgeTable& edges) {
  DoubleCover cover(mesh.triangles.size());
  edges.for_each([&](Index, Index, std::span<const EdgeSide> sides) {
    if (sides.size() == 2) {
      cover.join(sides[0].half_edge / 3, sides[1].half_edge / 3, agree(mesh.triangles, sides));
    }
  });
  return cover;
}

std::uint64_t count_used(const TriangleMesh& mesh, DisjointSets& components, std::uint32_t& count) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const Index v : t) used[v] = true;
    components.unite(t[0], t[1]);
    components.unite(t[0], t[2]);
  }
  const auto unused = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false));
  count = static_cast<std::uint32_t>(components.count() - unused);
  return used.size() - unused;
}

std::string plural(std::uint64_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

} // namespace

Topology classify(const TriangleMesh& mesh) {
  Topology out;
  out.triangles = mesh.triangles.size();
  DisjointSets components(mesh.positions.size());
  out.vertices = count_used(mesh, components, out.components);

  const EdgeTable edges(mesh.triangles, mesh.positions.size());
  DisjointSets fans(mesh.triangles.size() * 3), loops(mesh.positions.size());
  std::vector<Index> boundary;
  std::vector<bool> on_bad_edge(mesh.positions.size(), false);
  edges.for_each([&](Index low, Index high, std::span<const EdgeSide> sides) {
    ++out.edges;
    if (sides.size() == 1) {
      boundary.push_back(low);
      loops.unite(low, high);
    } else if (sides.size() > 2) {
      ++out.nonmanifold_edges;
      on_bad_edge[low] = on_bad_edge[high] = true;
      add_place(out, "edge from " + text_of(mesh.positions[low]) + " to " + text_of(mesh.positions[high]) + " has " +
                         std::to_string(sides.size()) + " triangles");
    } else if (!agree(mesh.triangles, sides)) {
      out.consistently_oriented = false;
    }
    for (std::size_t i = 1; i < sides.size(); ++i) {
      const auto a = corners_of(mesh.triangles, sides[0].half_edge), b = corners_of(mesh.triangles, sides[i].half_edge);
      fans.unite(a[0], b[0]);
      fans.unite(a[1], b[1]);
    }
  });
  out.boundary_edges = boundary.size();
  report_loops(mesh, loops, boundary, out);
  count_fans(mesh, fans, on_bad_edge, out);
  if (out.nonmanifold_edges > 0 || out.triangles < 4) out.duplicate_triangles = count_duplicates(mesh.triangles);
  if (!out.consistently_oriented) out.orientable = cover_of(mesh, edges).orientable();

  out.euler_characteristic = static_cast<std::int64_t>(out.vertices) - static_cast<std::int64_t>(out.edges) +
                             static_cast<std::int64_t>(out.triangles);
  const bool surface = out.components == 1 && out.boundary_edges == 0 && out.nonmanifold_edges == 0 &&
                       out.nonmanifold_vertices == 0 && out.orientable;
  out.genus = surface ? (2 - out.euler_characteristic) / 2 : -1;
  out.signed_volume = signed_volume(mesh);
  return out;
}

bool Topology::is_sphere() const { return genus == 0 && triangles >= 4 && duplicate_triangles == 0; }

std::string Topology::refusal() const {
  if (is_sphere()) return {};
  std::vector<std::string> found;
  if (triangles == 0) found.emplace_back("no triangles with three different vertices");
  if (components > 1) found.push_back(std::to_string(components) + " components");
  if (boundary_edges > 0) {
    found.push_back(plural(boundary_loops, "boundary loop", "boundary loops") + " (" +
                    plural(boundary_edges, "open edge", "open edges") + ")");
  }
  if (nonmanifold_edges > 0) found.push_back(plural(nonmanifold_edges, "non-manifold edge", "non-manifold edges"));
  if (nonmanifold_vertices > 0) {
    found.push_back(plural(nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices"));
  }
  if (duplicate_triangles > 0) {
    found.push_back(plural(duplicate_triangles, "duplicate triangle", "duplicate triangles"));
  }
  if (!orientable) found.emplace_back("a surface with only one side");
  if (genus > 0) found.push_back("genus " + std::to_string(genus));
  std::string text = "the surface is not one closed component of genus 0: found ";
  for (std::size_t i = 0; i < found.size(); ++i) text += (i == 0 ? "" : ", ") + found[i];
  if (!where.empty()) {
    text += "; for example ";
    for (std::size_t i = 0; i < std::min<std::size_t>(where.size(), 3); ++i) text += (i == 0 ? "" : "; ") + where[i];
  }
  return text;
}

std::vector<std::uint32_t> orient_consistently(TriangleMesh& mesh) {
  const EdgeTable edges(mesh.triangles, mesh.positions.size());
  bool consistent = true;
  edges.for_each([&](Index, Index, std::span<const EdgeSide> sides) {
    consistent = consistent && sides.size() == 2 && agree(mesh.triangles, sides);
  });
  if (consistent) return {};
  DoubleCover cover = cover_of(mesh, edges);
  std::vector<bool> turned(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    turned[t] = cover.turned(t);
    if (turned[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  if (signed_volume(mesh) < 0) {
    turned.flip();
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < turned.size(); ++t) {
    if (turned[t]) out.push_back(t);
  }
  return out;
}

} // namespace orbis::mesh
