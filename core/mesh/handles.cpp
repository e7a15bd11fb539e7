#include "core/mesh/handles.h"

#include <algorithm>
#include <queue>
#include <utility>
#include <vector>

#include "core/mesh/disjoint_sets.h"

namespace orbis::mesh {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr double infinity = std::numeric_limits<double>::infinity();
// Triangles looked at for shorter loops than one look a round finds: as many rounds as that are spent on a piece with
// few triangles or few handles.
constexpr std::uint64_t spare_work = 6'000'000;

// The piece with numbers of its own.
struct Piece {
  Gluing gluing; // triangles of points, as in the whole
  Fans fans;
  std::vector<Index> point;        // of each fan
  std::vector<std::uint32_t> face; // half-edge -> the boundary loop beyond it, numbered behind the triangles; else none
  std::uint32_t faces = 0;         // triangles and boundary loops
  [[nodiscard]] std::int64_t genus() const {
    std::uint64_t open = 0;
    for (const std::uint32_t h : gluing.twin) open += h == open_edge ? 1 : 0;
    const std::uint64_t edges = (gluing.twin.size() + open) / 2;
    return (2 - static_cast<std::int64_t>(fans.count) + static_cast<std::int64_t>(edges) - std::int64_t{faces}) / 2;
  }
};

void describe(Piece& piece) {
  piece.fans = fans_of(piece.gluing);
  piece.point.assign(piece.fans.count, 0);
  for (std::uint32_t c = 0; c < piece.gluing.twin.size(); ++c)
    piece.point[piece.fans.of_corner[c]] = piece.gluing.from(c);
  piece.face.assign(piece.gluing.twin.size(), none);
  piece.faces = static_cast<std::uint32_t>(piece.gluing.triangles.size());
  for (const auto& loop : boundary_loops(piece.gluing)) {
    for (const std::uint32_t h : loop) piece.face[h] = piece.faces;
    ++piece.faces;
  }
}

// The shortest paths from one vertex.
struct Tree {
  std::vector<double> distance;
  std::vector<std::uint32_t> parent; // fan -> half-edge that leads to it, either way; none at the root
  std::vector<std::uint32_t> depth;  // edges to the root
};

class Cutter {
public:
  Cutter(std::span<const Vec3f> positions, const Piece& piece) : positions_(positions), piece_(piece) { list_edges(); }

  // Finds the loops through the tree from `root`. Returns the length of the shortest.
  double look_from(Index root) {
    grow_tree(root);
    closing_.clear();
    for (const std::uint32_t h : generators()) closing_.emplace_back(length_of_loop(h), h);
    std::sort(closing_.begin(), closing_.end());
    return closing_.front().first;
  }

  // A vertex of the shortest loop that was found.
  [[nodiscard]] Index on_shortest() const { return start(closing_.front().second); }

  // The loops of the last look that can be cut at once, as half-edges; none longer than `longest`.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> loops(double longest) const {
    std::vector<bool> used(piece_.fans.count, false);
    std::vector<std::vector<std::uint32_t>> out;
    for (const auto& [length, h] : closing_) {
      if (length > longest) break;
      std::vector<std::uint32_t> loop = loop_of(h);
      if (std::ranges::any_of(loop, [&](std::uint32_t e) { return used[start(e)] || used[end(e)]; })) continue;
      for (const std::uint32_t e : loop) used[start(e)] = used[end(e)] = true;
      out.push_back(std::move(loop));
    }
    return out;
  }

  [[nodiscard]] double length(std::uint32_t h) const {
    return norm(Vec3d(positions_[piece_.point[end(h)]]) - Vec3d(positions_[piece_.point[start(h)]]));
  }

private:
  [[nodiscard]] Index start(std::uint32_t h) const { return piece_.fans.of_corner[h]; }
  [[nodiscard]] Index end(std::uint32_t h) const { return piece_.fans.of_corner[next_in_triangle(h)]; }

  // One half-edge for each edge, and for each vertex the edges at it.
  void list_edges() {
    const std::vector<std::uint32_t>& twin = piece_.gluing.twin;
    edges_.clear();
    for (std::uint32_t h = 0; h < twin.size(); ++h) {
      if (twin[h] == open_edge || h < twin[h]) edges_.push_back(h);
    }
    first_.assign(std::size_t{piece_.fans.count} + 1, 0);
    for (const std::uint32_t h : edges_) {
      ++first_[start(h) + 1];
      ++first_[end(h) + 1];
    }
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
    at_.resize(2 * edges_.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const std::uint32_t h : edges_) {
      at_[next[start(h)]++] = h;
      at_[next[end(h)]++] = h;
    }
  }

  void grow_tree(Index root) {
    tree_.distance.assign(piece_.fans.count, infinity);
    tree_.parent.assign(piece_.fans.count, none);
    tree_.depth.assign(piece_.fans.count, 0);
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    tree_.distance[root] = 0;
    queue.emplace(0, root);
    while (!queue.empty()) {
      const auto [distance, v] = queue.top();
      queue.pop();
      if (distance > tree_.distance[v]) continue;
      for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
        const std::uint32_t h = at_[i];
        const Index w = start(h) == v ? end(h) : start(h);
        const double through = distance + length(h);
        if (!(through < tree_.distance[w])) continue;
        tree_.distance[w] = through;
        tree_.parent[w] = h;
        tree_.depth[w] = tree_.depth[v] + 1;
        queue.emplace(through, w);
      }
    }
  }

  [[nodiscard]] bool in_tree(std::uint32_t h) const { return tree_.parent[start(h)] == h || tree_.parent[end(h)] == h; }

  [[nodiscard]] std::uint32_t face_beyond(std::uint32_t h) const {
    return piece_.gluing.is_open(h) ? piece_.face[h] : piece_.gluing.twin[h] / 3;
  }

  // The edges in neither tree: the cotree takes the dual edges whose loops are longest.
  std::vector<std::uint32_t> generators() {
    std::vector<std::pair<double, std::uint32_t>> order;
    for (const std::uint32_t h : edges_) {
      if (!in_tree(h)) order.emplace_back(-(tree_.distance[start(h)] + tree_.distance[end(h)] + length(h)), h);
    }
    std::sort(order.begin(), order.end());
    DisjointSets cotree(piece_.faces);
    std::vector<std::uint32_t> out;
    for (const auto& [negative_length, h] : order) {
      if (cotree.find(h / 3) == cotree.find(face_beyond(h))) {
        out.push_back(h);
      } else {
        cotree.unite(h / 3, face_beyond(h));
      }
    }
    return out;
  }

  [[nodiscard]] Index up(Index v) const {
    const std::uint32_t h = tree_.parent[v];
    return start(h) == v ? end(h) : start(h);
  }

  // Where the paths from the ends of h to the root meet.
  [[nodiscard]] Index meeting(std::uint32_t h) const {
    Index v = start(h), w = end(h);
    while (v != w) {
      if (tree_.depth[v] < tree_.depth[w]) std::swap(v, w);
      v = up(v);
    }
    return v;
  }

  [[nodiscard]] double length_of_loop(std::uint32_t h) const {
    return tree_.distance[start(h)] + tree_.distance[end(h)] + length(h) - 2 * tree_.distance[meeting(h)];
  }

  [[nodiscard]] std::vector<std::uint32_t> loop_of(std::uint32_t h) const {
    std::vector<std::uint32_t> out{h};
    const Index top = meeting(h);
    for (Index v : {start(h), end(h)}) {
      for (; v != top; v = up(v)) out.push_back(tree_.parent[v]);
    }
    return out;
  }

  std::span<const Vec3f> positions_;
  const Piece& piece_;
  std::vector<std::uint32_t> edges_, first_, at_;
  Tree tree_;
  std::vector<std::pair<double, std::uint32_t>> closing_; // length of the loop, edge that closes it; ascending
};

Piece extract(std::span<const std::uint32_t> triangles, const Gluing& whole) {
  Piece out;
  // By search, not by a table: a whole may have many pieces.
  const auto place = [&](std::uint32_t t) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(triangles, t) - triangles.begin());
  };
  for (const std::uint32_t t : triangles) {
    out.gluing.triangles.push_back(whole.triangles[t]);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      out.gluing.twin.push_back(whole.is_open(h) ? open_edge : 3 * place(whole.twin[h] / 3) + whole.twin[h] % 3);
    }
  }
  return out;
}

} // namespace

HandleCut cut_handles(std::span<const Vec3f> positions, std::span<const std::uint32_t> triangles, Gluing& gluing) {
  HandleCut out;
  Piece piece = extract(triangles, gluing);
  describe(piece);
  std::uint64_t spare = spare_work / triangles.size(); // looks that only make loops shorter
  for (std::uint32_t round = 0; piece.genus() > 0 && pieces_of(piece.gluing).count == 1; ++round) {
    Cutter cutter(positions, piece);
    // Another root each round, scattered over the piece (by the golden ratio).
    const auto root =
        static_cast<Index>(std::uint64_t{round} * 2654435769ULL % 4294967296ULL * piece.fans.count >> 32U);
    double shortest = cutter.look_from(root);
    // The shortest loop through a vertex of this one may be shorter.
    for (bool better = true; better && spare > 0; --spare) {
      const double length = cutter.look_from(cutter.on_shortest());
      better = length < shortest * (1 - 1e-9);
      shortest = std::min(shortest, length);
    }
    for (const std::vector<std::uint32_t>& loop : cutter.loops(spare > 0 ? shortest * 1.001 : infinity)) {
      ++out.loops;
      for (const std::uint32_t h : loop) {
        if (piece.gluing.is_open(h)) continue; // the loop follows a boundary for a while
        ++out.edges;
        out.length += cutter.length(h);
        piece.gluing.unglue(h);
        gluing.unglue(3 * triangles[h / 3] + h % 3);
      }
    }
    describe(piece);
  }
  return out;
}

} // namespace orbis::mesh
