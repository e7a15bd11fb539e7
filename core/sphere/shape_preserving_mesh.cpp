#include "core/sphere/shape_preserving_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <queue>

namespace orbis::sphere {
namespace {

constexpr std::size_t check_every = 1024;

using mesh::Index;
using Edge = HalfEdgeMesh::EdgeHandle;
using HalfEdge = HalfEdgeMesh::HalfedgeHandle;
using Vertex = HalfEdgeMesh::VertexHandle;

Vertex handle(Index v) { return Vertex(static_cast<int>(v)); }
Index index(Vertex v) { return static_cast<Index>(v.idx()); }

// The edges of a mesh, shortest first. An edge whose collapse is forbidden waits, out of the queue, until a collapse
// next to it may have freed it.
class ShortestEdges {
public:
  explicit ShortestEdges(const HalfEdgeMesh& mesh) : mesh_(mesh), waiting_(mesh.n_edges(), false) {
    std::vector<Entry> all;
    all.reserve(mesh.n_edges());
    for (const Edge e : mesh.edges()) all.push_back(entry(e));
    queue_ = Queue(std::greater<>(), std::move(all));
  }

  // The shortest edge that is not waiting. Invalid where there is none.
  Edge pop() {
    while (!queue_.empty()) {
      const Entry top = queue_.top();
      queue_.pop();
      const Edge e(top.edge);
      // An edge is queued again when it gets longer: the older entry no longer agrees with the mesh.
      if (!mesh_.status(e).deleted() && top.length == length_class(e)) return e;
    }
    return Edge();
  }

  void push(Edge e) {
    queue_.push(entry(e));
    waiting_[static_cast<std::size_t>(e.idx())] = false;
  }
  void wait(Edge e) { waiting_[static_cast<std::size_t>(e.idx())] = true; }
  void push_if_waiting(Edge e) {
    if (waiting_[static_cast<std::size_t>(e.idx())] && !mesh_.status(e).deleted()) push(e);
  }

private:
  struct Entry {
    std::uint32_t length; // see length_class
    std::uint32_t order;  // among edges of one class
    int edge;
    auto operator<=>(const Entry&) const = default;
  };

  using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

  // The bits of a positive float order like its value: without the last twelve, lengths that agree to 0.03 % are equal.
  // Regular meshes have many edges of one length but for rounding; taken in a scattered order they thin out evenly,
  // where the order of the file would eat them up from one end.
  [[nodiscard]] std::uint32_t length_class(Edge e) const {
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::sqrt(mesh_.calc_edge_sqr_length(e)))) >> 12;
  }
  [[nodiscard]] Entry entry(Edge e) const {
    const auto n = static_cast<std::uint32_t>(e.idx());
    const std::uint32_t mixed = (n ^ (n >> 15)) * 0x2c1b3c6dU; // any multiplicative hash will do
    return {length_class(e), mixed ^ (mixed >> 13), e.idx()};
  }

  const HalfEdgeMesh& mesh_;
  Queue queue_;
  std::vector<bool> waiting_;
};

// The half-edge from the end that goes to the end that stays. Removing the end of lower valence keeps hubs from being
// rebuilt, and makes a split touch few triangles.
HalfEdge collapse_direction(const HalfEdgeMesh& mesh, Edge e) {
  const HalfEdge h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
  const Vertex a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
  const auto va = mesh.valence(a), vb = mesh.valence(b);
  return va < vb || (va == vb && a.idx() > b.idx()) ? h : o;
}

// A forbidden edge lies on a triangle of edges that is no face. The triangle is freed only when all on one side of it
// is gone: with the collapse into one of its corners. So only spokes and ring of that corner need another look.
void wake_around(const HalfEdgeMesh& mesh, Vertex v, ShortestEdges& edges) {
  for (const HalfEdge h : mesh.voh_range(v)) {
    edges.push_if_waiting(mesh.edge_handle(h));
    edges.push_if_waiting(mesh.edge_handle(mesh.next_halfedge_handle(h)));
  }
}

Collapse collapse(HalfEdgeMesh& mesh, HalfEdge h, ShortestEdges& edges) {
  const Vertex removed = mesh.from_vertex_handle(h), parent = mesh.to_vertex_handle(h);
  const Vertex left = mesh.opposite_vh(h), right = mesh.opposite_he_opposite_vh(h);
  std::vector<Edge> moved;
  for (const Edge e : mesh.ve_range(removed)) moved.push_back(e);
  mesh.collapse(h);
  for (const Edge e : moved)
    if (!mesh.status(e).deleted()) edges.push(e);
  wake_around(mesh, parent, edges);
  return {index(removed), index(parent), index(left), index(right)};
}

} // namespace

HalfEdgeMesh make_half_edge_mesh(const mesh::TriangleMesh& mesh, const std::vector<Vec3d>& positions,
                                 Progress& progress) {
  HalfEdgeMesh out;
  out.reserve(positions.size(), mesh.triangles.size() * 3 / 2, mesh.triangles.size());
  for (const Vec3d& p : positions) out.add_vertex({p.x, p.y, p.z});
  for (const mesh::Triangle& t : mesh.triangles) {
    if (t[0] % check_every == 0) progress.check();
    if (!out.add_face(handle(t[0]), handle(t[1]), handle(t[2])).is_valid())
      throw Error(ErrorCode::not_genus_zero, "the triangles do not form a closed, consistently oriented surface");
  }
  return out;
}

std::vector<Collapse> collapse_to_tetrahedron(HalfEdgeMesh& mesh, Progress& progress) {
  ShortestEdges edges(mesh);
  const std::size_t total = mesh.n_vertices() - 4;
  std::vector<Collapse> collapses;
  collapses.reserve(total);
  for (std::size_t tried = 1; collapses.size() < total; ++tried) {
    if (tried % check_every == 0) {
      progress.check();
      progress.report(Stage::simplify, collapses.size(), total);
    }
    const Edge e = edges.pop();
    if (!e.is_valid())
      throw Error(ErrorCode::not_genus_zero, "the surface cannot be collapsed to a tetrahedron: it is not a sphere");
    const HalfEdge h = collapse_direction(mesh, e);
    if (mesh.is_collapse_ok(h))
      collapses.push_back(collapse(mesh, h, edges));
    else
      edges.wait(e);
  }
  progress.report(Stage::simplify, total, total);
  return collapses;
}

void split_vertex(HalfEdgeMesh& mesh, const Collapse& collapse) {
  const Vertex removed = handle(collapse.removed);
  mesh.status(removed).set_deleted(false);
  mesh.vertex_split(removed, handle(collapse.parent), handle(collapse.left), handle(collapse.right));
}

void one_ring(const HalfEdgeMesh& mesh, Index v, std::vector<Index>& ring) {
  ring.clear();
  const HalfEdge first = mesh.halfedge_handle(handle(v));
  HalfEdge h = first;
  do {
    ring.push_back(index(mesh.to_vertex_handle(h)));
    h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
  } while (h != first);
}

} // namespace orbis::sphere
