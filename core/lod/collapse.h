// One edge collapse: where the vertex that is left should go, and whether it may.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lod/wedge_mesh.h"

namespace orbis::lod {

// What a collapse must respect beside the map, which never folds.
struct Constraints {
  bool keeps_normals = true; // no triangle turns by more than some 80 degrees at once
  // How far, in the atlas, a seam may leave the outline of the full surface's charts. Rounding is always allowed.
  double outline_tolerance = 0;
  // The same where the surface ends, at a hole or rim: there is no other side that would have to follow.
  double border_tolerance = 0;
};

struct Collapse {
  std::uint32_t removed = 0, kept = 0;
  EdgeSides sides;            // at_a: wedges of the removed point, at_b: those of the kept one that take their place
  Vec3d position;             // of the kept point
  std::optional<Uv> moved_to; // its new place in the atlas (scaled); else it keeps its own
  double cost = 0;            // Q there
};

class Collapser {
public:
  Collapser(const FullSurface& full, WedgeMesh& mesh);

  // The attempts for an edge (a, b), best first by design: 0 where Q is least, if both ends may move; then with the
  // place in the atlas of one end, the one of the smaller Q first. Nothing where there are fewer.
  [[nodiscard]] std::optional<Collapse> propose(std::uint32_t a, std::uint32_t b, std::uint32_t attempt) const;

  // Does it if the result is sound: the link condition holds; in the atlas (for float32) and on the sphere (on the
  // grid) every changed triangle is positively oriented, decided exactly; and `constraints` hold.
  bool perform(const Collapse& collapse, const Constraints& constraints);

private:
  struct Goal { // the kept point after the collapse
    Vec3d position;
    sphere::GridPoint sphere{};
    Vec2f uv; // of its wedge, where it has only one
    Place place;
    bool has_moved = false;
  };

  [[nodiscard]] std::optional<Collapse> keep(std::uint32_t kept, std::uint32_t removed, const EdgeSides& sides) const;
  [[nodiscard]] std::optional<Collapse> move_both(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const;
  [[nodiscard]] std::optional<Goal> goal_of(const Collapse& collapse) const;
  [[nodiscard]] bool keeps_outline(const Collapse& collapse, const Constraints& constraints, double& drift) const;
  [[nodiscard]] bool keeps_triangles(const Collapse& collapse, const Goal& goal, const Constraints& constraints) const;
  [[nodiscard]] Uv scaled(const Vec2f& uv) const;

  const FullSurface& full_;
  WedgeMesh& mesh_;
  std::vector<std::int8_t> sign_; // by region: the orientation of its triangles in the atlas
};

} // namespace orbis::lod
