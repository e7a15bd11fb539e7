// Where the point goes that is left of an edge on a rim: on the surface's side of the rim, so that a level never shows
// what lies outside of its charts.
#pragma once

#include <optional>
#include <span>

#include "core/lod/deviation_quadric.h"

namespace orbis::lod {

// The half-plane of the places u with normal . u >= offset; unit normal.
struct HalfPlane {
  Uv normal{};
  double offset = 0;

  // To the left of the way from a to b where sign is 1, to the right where it is -1.
  [[nodiscard]] static HalfPlane beside(const Uv& a, const Uv& b, int sign, double margin);
};

// The place in all of `allowed` where the quadratic `model`, made at `from`, is smallest: a quadratic programme so
// small that its corners, sides and inside are tried one after the other. Nothing where they have no place in common.
[[nodiscard]] std::optional<Uv> best_place_within(const DeviationQuadric::Reduced& model, const Uv& from,
                                                  std::span<const HalfPlane> allowed);

} // namespace orbis::lod
