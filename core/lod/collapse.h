// One edge collapse: where the vertex that is left should go, and whether it may.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/lod/wedge_mesh.h"

namespace orbis::lod {

// What a collapse must respect beside the map, which never folds, and the charts, which no triangle ever leaves.
struct Constraints {
  bool keeps_normals = true; // no triangle turns by more than some 80 degrees at once
  // The rims of a cut change together, so that no gap opens.
  bool keeps_joints = true;
};

// Seams stay seams, on the outline that they have on the full surface: one side shows what the other does. Where that
// is not kept the texture may be torn: a point may leave its place at a seam while its copies in other charts stay, a
// seam may leave its outline, and the last three points of a hole may become one edge.
enum class Seams : std::uint8_t { kept, broken };

// What a collapse that breaks seams costs, as a multiple of Q: the error of the texels beside them is in Q already,
// that they do not fit together is not. docs/lods.md says what other prices do.
inline constexpr double price_of_seams = 16;

struct Collapse {
  std::uint32_t removed = 0, kept = 0;
  EdgeSides sides;                     // at_a: wedges of the removed point, at_b: those of the kept one
  std::array<std::uint32_t, 2> into{}; // what each wedge at_a becomes: the one at_b, or itself where it stays
  Vec3d position;                      // of the kept point
  std::optional<Uv> moved_to;          // its new place in the atlas (scaled); else it keeps its own
  double cost = 0;                     // Q there
  Seams seams = Seams::kept;

  [[nodiscard]] bool tears() const { return into[0] == sides.at_a[0] || into[1] == sides.at_a[1]; }
  // Whether a wedge of the removed point stays in the atlas as it is.
  [[nodiscard]] bool stays(std::uint32_t wedge) const {
    return (wedge != sides.at_a[0] || into[0] == wedge) && (wedge != sides.at_a[1] || into[1] == wedge);
  }
  [[nodiscard]] double price() const { return seams == Seams::kept ? 1 : price_of_seams; }
};

class Collapser {
public:
  Collapser(const FullSurface& full, WedgeMesh& mesh);

  static constexpr std::uint32_t attempts = 9;

  // The attempts for an edge (a, b), best first by design: 0 where Q is least, if both ends may move; then with the
  // place in the atlas of one end, the one of the smaller Q first; then, if seams need not be kept, those that tear.
  // Nothing where there are fewer.
  [[nodiscard]] std::optional<Collapse> propose(std::uint32_t a, std::uint32_t b, Seams seams,
                                                std::uint32_t attempt) const;
  // Whether there is a seam at either end.
  [[nodiscard]] bool meets_seam(std::uint32_t a, std::uint32_t b) const {
    return mesh_.points[a].kind != PointKind::interior || mesh_.points[b].kind != PointKind::interior;
  }

  // Does it if the result is sound: the link condition holds; in the atlas (for float32) and on the sphere (on the
  // grid) every changed triangle is positively oriented, decided exactly; no triangle covers a place in the atlas that
  // its chart did not; and `constraints` hold. Where the surface was cut apart, its other rims do the same, or none
  // does. The points that are left, of none if it was not done.
  [[nodiscard]] std::span<const std::uint32_t> perform(const Collapse& collapse);

  Constraints constraints;

private:
  struct Goal { // the kept point after the collapse
    Vec3d position;
    sphere::GridPoint sphere{};
    Vec2f uv; // of its wedge, where it has only one
    Place place;
    bool has_moved = false;  // in the atlas, and so on the sphere
    bool has_turned = false; // on the sphere alone
    double drift = 0;        // of the seam from its outline
  };
  struct Step {
    Collapse collapse;
    Goal goal;
  };

  // Whether a may become b.
  [[nodiscard]] bool may_go(std::uint32_t a, std::uint32_t b, const EdgeSides& sides, Seams seams) const;
  // stays: bit i: the removed point's wedge on side i keeps its place in the atlas.
  [[nodiscard]] std::optional<Collapse> keep(std::uint32_t kept, std::uint32_t removed, const EdgeSides& sides,
                                             unsigned stays) const;
  [[nodiscard]] std::optional<Collapse> move_both(std::uint32_t a, std::uint32_t b, const EdgeSides& sides) const;
  [[nodiscard]] std::optional<Uv> rim_place(const DeviationQuadric& q, const Uv& middle, const EdgeSides& sides) const;
  [[nodiscard]] std::optional<Goal> goal_of(const Collapse& collapse) const;
  [[nodiscard]] bool keeps_outline(const Collapse& collapse, double& drift) const;
  [[nodiscard]] bool stays_inside(std::uint32_t wedge, const Vec2f& to) const;
  [[nodiscard]] bool keeps_charts(const Collapse& collapse, const Goal& goal) const;
  [[nodiscard]] bool keeps_triangles(const Collapse& collapse, const Goal& goal) const;
  [[nodiscard]] const Wedge* same_primitive_at(std::uint32_t point, const Wedge& wedge) const;
  [[nodiscard]] bool finds_attributes(const Collapse& collapse) const;
  [[nodiscard]] std::optional<Goal> check(const Collapse& collapse);
  [[nodiscard]] bool add_twins(const Collapse& collapse);
  [[nodiscard]] std::optional<Step> twin_step(std::uint32_t twin, std::uint32_t joint, Seams seams);
  [[nodiscard]] bool are_apart() const;
  void apply(const Step& step);
  void tear(const Collapse& collapse);
  [[nodiscard]] Uv scaled(const Vec2f& uv) const;

  const FullSurface& full_;
  WedgeMesh& mesh_;
  std::vector<int> sign_;   // by region: the orientation of its triangles in the atlas
  std::vector<Step> steps_; // of the collapse in work, with its twins
  std::vector<std::uint32_t> kept_;
};

} // namespace orbis::lod
