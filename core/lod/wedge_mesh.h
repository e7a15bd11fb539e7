// A mesh under simplification: points in space, and their wedges, which are what a region of the atlas sees of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lod/deviation_quadric.h"
#include "core/lod/full_surface.h"
#include "core/mesh/thread_pool.h"

namespace orbis::lod {

// interior: one wedge all around. seam: two seam edges end here, or the surface does. fixed: where seams meet or end.
enum class PointKind : std::uint8_t { interior, seam, fixed };

struct Wedge {
  std::uint32_t point = 0, region = 0;
  Vec2f uv;
  // Where its attributes come from: a place on a triangle of the welded surface.
  std::uint32_t source = 0;
  std::array<double, 3> weights{};
  std::uint32_t near = 0; // a triangle of the cut mesh close by, where walks begin
};

struct Point {
  Vec3d position; // scaled as in FullSurface
  sphere::GridPoint sphere{};
  std::uint32_t first_corner = none; // of the list of corners that lie here
  std::uint32_t version = 0;         // counts the changes around the point
  PointKind kind = PointKind::interior;
  float drift = 0; // how far seams through here have left the outline of the full surface's charts, in the atlas
  bool is_alive = true;
  bool is_joint = false;      // never moves: FullSurface::is_joint
  std::uint32_t joint = none; // FullSurface::joint_of
};

// The wedges of an edge (a, b) on each of its two sides. Where the surface ends there is one side, named twice.
struct EdgeSides {
  std::array<std::uint32_t, 2> at_a{}, at_b{}, triangle{};
  [[nodiscard]] bool is_border() const { return triangle[0] == triangle[1]; }
  [[nodiscard]] bool is_seam() const { return is_border() || at_a[0] != at_a[1] || at_b[0] != at_b[1]; }
};

// Corner 3 t + k is corner k of triangle t.
class WedgeMesh {
public:
  WedgeMesh(const FullSurface& full, mesh::ThreadPool& threads);

  std::vector<Point> points;
  std::vector<Wedge> wedges;
  std::vector<DeviationQuadric> quadrics;           // one per wedge
  std::vector<mesh::Triangle> triangles;            // wedges
  std::vector<mesh::Triangle> corner_points;        // triangle -> the points of its wedges: walks need nothing else
  std::vector<std::uint32_t> parent;                // triangle -> triangle of the welded surface
  std::vector<bool> is_alive;                       // by triangle
  std::uint64_t triangle_count = 0;                 // of those alive
  std::vector<std::vector<std::uint32_t>> at_joint; // joint -> the points there

  [[nodiscard]] std::uint32_t point_at(std::uint32_t corner) const { return corner_points[corner / 3][corner % 3]; }
  // Calls visit(corner) for each triangle around a point.
  template <class Visit> void for_each_corner(std::uint32_t point, Visit visit) const {
    for (std::uint32_t c = points[point].first_corner; c != none; c = next_corner_[c])
      if (is_alive[c / 3]) visit(c);
  }
  // The wedges on both sides of an edge; nothing where it has more than two triangles, or none.
  [[nodiscard]] std::optional<EdgeSides> sides_of(std::uint32_t a, std::uint32_t b) const;
  // The points around a point, each once, in the order in which the triangles were listed.
  void neighbours_of(std::uint32_t point, std::vector<std::uint32_t>& out) const;
  // Link condition of Dey et al., Topology preserving edge contraction (1999): the ends have no neighbour in common but
  // those of the edge's triangles; no edge through the surface joins two points where it ends; and more than the edge's
  // own triangles, or two of a tetrahedron, would be left. closes_holes: the edge of a hole of three may go too, so
  // that the other two become one edge inside the surface.
  [[nodiscard]] bool link_condition(std::uint32_t a, std::uint32_t b, const EdgeSides& sides, bool closes_holes);
  [[nodiscard]] bool is_on_border(std::uint32_t point) const;
  // Whether the points before and behind it on its rim are joints.
  [[nodiscard]] bool is_between_joints(std::uint32_t point) const;

  // The way along the outline of its chart at a wedge: the place before and the place behind it, with the surface to
  // the left where triangles are positively oriented in the atlas. What another region of the chart continues is no
  // outline.
  struct Outline {
    std::size_t edges = 0; // 0: none passes; 2: one does; else they meet here
    Vec2f before, behind;
  };
  [[nodiscard]] Outline outline_at(const FullSurface& full, std::uint32_t wedge) const;

  // Removes the triangles of the edge and hands the others around `removed` to `kept`. sides.at_a are wedges of
  // `removed`; each becomes the wedge of `kept` in `into`, quadrics added, or stays in the atlas where that names
  // itself, as all further wedges of `removed` do.
  void contract(std::uint32_t removed, std::uint32_t kept, const EdgeSides& sides,
                const std::array<std::uint32_t, 2>& into);

  // Takes all triangles of the component that a point belongs to away; returns how many there were.
  std::uint64_t remove_component(std::uint32_t point);

private:
  void make_wedges(const FullSurface& full);
  void list_corners();
  void classify(mesh::ThreadPool& threads);
  void wall_borders(const FullSurface& full);
  void inherit(std::uint32_t wedge);
  void wall(const EdgeSides& sides, std::size_t side, std::uint32_t p, std::uint32_t q);
  [[nodiscard]] bool is_hole_of_three(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const;

  double uv_scale_; // FullSurface::uv_scale
  std::vector<std::uint32_t> next_corner_;
  std::vector<std::uint32_t> mark_; // by point, for link_condition
  std::uint32_t marks_ = 0;
};

} // namespace orbis::lod
