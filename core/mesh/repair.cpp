#include "core/mesh/repair.h"

#include <algorithm>

#include "core/mesh/cap.h"
#include "core/mesh/gluing.h"
#include "core/mesh/orient.h"
#include "core/mesh/shared_edges.h"
#include "core/mesh/t_junctions.h"

namespace orbis::mesh {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// Triangles by piece, ascending; pieces in the order of their first triangle.
std::vector<std::vector<std::uint32_t>> triangles_by_piece(const Pieces& pieces) {
  std::vector<std::vector<std::uint32_t>> out(pieces.count);
  for (std::uint32_t t = 0; t < pieces.of_triangle.size(); ++t) out[pieces.of_triangle[t]].push_back(t);
  return out;
}

class Repair {
public:
  Repair(std::span<const Vec3f> positions, std::span<const Triangle> triangles, std::span<const Triangle> corners,
         double tolerance)
      : positions_(positions), soup_triangles_(static_cast<std::uint32_t>(triangles.size())) {
    GluedSoup glued = glue_pairs(triangles, positions.size());
    gluing_ = std::move(glued.gluing);
    shared_ = std::move(glued.shared);
    out_.counts.shared_edges = static_cast<std::uint64_t>(
        std::ranges::count_if(shared_, [](const std::vector<std::uint32_t>& sides) { return sides.size() > 2; }));
    Orientation orientation = orient(positions, gluing_);
    out_.turned = std::move(orientation.turned);
    out_.counts.one_sided_edges = orientation.cut_edges;
    rename_turned_sides();
    glue_shared_edges(positions, turned(corners), shared_, gluing_);
    if (close_t_junctions(positions, tolerance, gluing_) > 0) {
      shared_ = shared_edges(gluing_.triangles, positions.size());
    }
    out_.counts.double_edges = separate_double_edges(shared_, gluing_);
  }

  Repaired run() {
    std::vector<std::vector<std::uint32_t>> pieces = triangles_by_piece(pieces_of(gluing_));
    count_internal(pieces);
    count_splits();
    out_.pieces = described(pieces);
    for (std::vector<ClosedPiece> now = out_.pieces; cut_all_handles(pieces, now);) now = separated(pieces);
    assemble(pieces);
    return std::move(out_);
  }

private:
  [[nodiscard]] std::vector<Triangle> turned(std::span<const Triangle> corners) const {
    std::vector<Triangle> out(corners.begin(), corners.end());
    for (std::size_t t = 0; t < out.size(); ++t) {
      if (out_.turned[t]) std::swap(out[t][1], out[t][2]);
    }
    return out;
  }

  // In a turned triangle half-edges 0 and 2 have changed places.
  void rename_turned_sides() {
    for (auto& sides : shared_) {
      for (std::uint32_t& h : sides) {
        if (out_.turned[h / 3]) h = 3 * (h / 3) + 2 - h % 3;
      }
    }
  }

  // A wall inside a body: open, and other sheets along all of its boundary.
  void count_internal(const std::vector<std::vector<std::uint32_t>>& pieces) {
    std::vector<bool> is_shared(gluing_.twin.size(), false);
    for (const auto& sides : shared_) {
      // The two sides of a sheet that share only its border are no walls.
      for (const std::uint32_t h : sides) is_shared[h] = sides.size() > 2;
    }
    for (const auto& piece : pieces) {
      bool open = false, walled = true;
      for (const std::uint32_t t : piece) {
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          if (!gluing_.is_open(h)) continue;
          open = true;
          walled = walled && is_shared[h];
        }
      }
      if (open && walled) out_.counts.internal_triangles += piece.size();
    }
  }

  void count_splits() {
    const Fans fans = fans_of(gluing_);
    std::vector<bool> used(positions_.size(), false);
    for (const Triangle& t : gluing_.triangles) {
      for (const Index v : t) used[v] = true;
    }
    out_.counts.split_vertices = fans.count - static_cast<std::uint64_t>(std::ranges::count(used, true));
  }

  // Boundary loops and genus of each piece, as they are now.
  [[nodiscard]] std::vector<ClosedPiece> described(const std::vector<std::vector<std::uint32_t>>& pieces) const {
    std::vector<ClosedPiece> out(pieces.size());
    const Pieces of = pieces_of(gluing_);
    const Fans fans = fans_of(gluing_);
    std::vector<std::int64_t> vertices(pieces.size(), 0);
    std::vector<bool> seen(fans.count, false);
    for (std::uint32_t c = 0; c < fans.of_corner.size(); ++c) {
      if (seen[fans.of_corner[c]]) continue;
      seen[fans.of_corner[c]] = true;
      ++vertices[of.of_triangle[c / 3]];
    }
    for (const auto& loop : boundary_loops(gluing_)) {
      ClosedPiece& piece = out[of.of_triangle[loop.front() / 3]];
      ++piece.boundary_loops;
      piece.boundary_edges += static_cast<std::uint32_t>(loop.size());
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto faces = static_cast<std::int64_t>(pieces[i].size());
      const std::int64_t edges = (3 * faces + out[i].boundary_edges) / 2;
      out[i].genus = static_cast<std::uint32_t>((2 - vertices[i] + edges - faces - out[i].boundary_loops) / 2);
    }
    return out;
  }

  // now: the pieces as they are. Returns whether there were any handles.
  bool cut_all_handles(const std::vector<std::vector<std::uint32_t>>& pieces, const std::vector<ClosedPiece>& now) {
    bool any = false;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (now[i].genus == 0) continue;
      const HandleCut cut = cut_handles(positions_, pieces[i], gluing_);
      HandleCut& sum = out_.pieces[i].handles;
      sum = {sum.loops + cut.loops, sum.edges + cut.edges, sum.length + cut.length};
      any = true;
    }
    return any;
  }

  // A loop that follows boundaries can cut a piece in two. The part with the piece's first triangle keeps what was
  // found out about it, the others are pieces from here on. Returns the pieces as they are now.
  std::vector<ClosedPiece> separated(std::vector<std::vector<std::uint32_t>>& pieces) {
    std::vector<std::vector<std::uint32_t>> parts = triangles_by_piece(pieces_of(gluing_));
    std::vector<ClosedPiece> now = described(parts), facts = now;
    for (std::size_t i = 0, j = 0; i < parts.size() && j < pieces.size(); ++i) {
      if (parts[i].front() == pieces[j].front()) facts[i] = out_.pieces[j++];
    }
    pieces = std::move(parts);
    out_.pieces = std::move(facts);
    return now;
  }

  void assemble(const std::vector<std::vector<std::uint32_t>>& pieces) {
    const Pieces of = pieces_of(gluing_);
    const Fans fans = fans_of(gluing_);
    place_.assign(fans.count, none);
    std::vector<std::vector<std::vector<std::uint32_t>>> loops(pieces.size());
    for (auto& loop : boundary_loops(gluing_)) loops[of.of_triangle[loop.front() / 3]].push_back(std::move(loop));
    for (std::size_t i = 0; i < pieces.size(); ++i) append(pieces[i], loops[i], fans, out_.pieces[i]);
    // What was put between two sheets that then came apart is no piece of the soup.
    std::erase_if(out_.pieces, [](const ClosedPiece& piece) { return piece.triangles == 0; });
  }

  void append(std::span<const std::uint32_t> triangles, const std::vector<std::vector<std::uint32_t>>& loops,
              const Fans& fans, ClosedPiece& piece) {
    if (triangles.front() >= soup_triangles_) return;
    piece.first_vertex = static_cast<std::uint32_t>(out_.mesh.positions.size());
    piece.first_triangle = static_cast<std::uint32_t>(out_.mesh.triangles.size());
    for (const std::uint32_t t : triangles) {
      const bool from_soup = t < soup_triangles_;
      Triangle placed{};
      for (std::uint32_t k = 0; k < 3; ++k) placed[k] = place(fans.of_corner[3 * t + k], gluing_.triangles[t][k]);
      out_.mesh.triangles.push_back(placed);
      out_.triangle_of.push_back(from_soup ? t : added_triangle);
      piece.turned_triangles += from_soup && out_.turned[t] ? 1 : 0;
      piece.crack_triangles += from_soup ? 0 : 1;
      piece.soup_triangles += from_soup ? 1 : 0;
      if (from_soup) piece.soup_vertices = static_cast<std::uint32_t>(out_.mesh.positions.size()) - piece.first_vertex;
    }
    for (const auto& loop : loops) close(loop, fans);
    piece.caps = static_cast<std::uint32_t>(loops.size());
    piece.vertices = static_cast<std::uint32_t>(out_.mesh.positions.size()) - piece.first_vertex;
    piece.triangles = static_cast<std::uint32_t>(out_.mesh.triangles.size()) - piece.first_triangle;
  }

  Index place(Index fan, Index point) {
    if (place_[fan] == none) {
      place_[fan] = static_cast<Index>(out_.mesh.positions.size());
      out_.mesh.positions.push_back(positions_[point]);
      out_.point_of.push_back(point);
    }
    return place_[fan];
  }

  void close(std::span<const std::uint32_t> loop, const Fans& fans) {
    std::vector<Vec3f> positions;
    for (const std::uint32_t h : loop) positions.push_back(positions_[gluing_.from(h)]);
    const Cap cap = make_cap(positions);
    const auto first = static_cast<Index>(out_.mesh.positions.size());
    out_.mesh.positions.insert(out_.mesh.positions.end(), cap.positions.begin(), cap.positions.end());
    out_.point_of.insert(out_.point_of.end(), cap.positions.size(), none);
    const auto n = static_cast<Index>(loop.size());
    for (const Triangle& t : cap.triangles) {
      Triangle placed{};
      for (std::size_t k = 0; k < 3; ++k) {
        placed[k] = t[k] < n ? place_[fans.of_corner[loop[t[k]]]] : first + t[k] - n;
      }
      out_.mesh.triangles.push_back(placed);
      out_.triangle_of.push_back(added_triangle);
    }
  }

  std::span<const Vec3f> positions_;
  std::uint32_t soup_triangles_;
  Gluing gluing_;
  SharedEdges shared_;
  std::vector<Index> place_; // fan -> vertex of the repaired mesh
  Repaired out_;
};

} // namespace

Repaired repair(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                std::span<const Triangle> corners, double tolerance) {
  return Repair(positions, triangles, corners, tolerance).run();
}

} // namespace orbis::mesh
